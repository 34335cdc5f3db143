// SPDX-License-Identifier: Apache-2.0
#include "fleet/link/link.h"

#include <poll.h>
#include <signal.h>
#include <sodium.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "core/doorbell.h"
#include "core/thread.h"
#include "core/token_bucket.h"
#include "fleet/link/channel.h"
#include "fleet/link/protocol.h"
#include "fleet/link/turns.h"
#include "fleet/wire/nkey.h"

namespace dts::fleet::link {
namespace {

using std::chrono::milliseconds;
using Time = std::chrono::steady_clock::time_point;

constexpr milliseconds kConnectTimeout{5000};  // for TCP; and again for TLS and the first answers
constexpr milliseconds kPingInterval{5000};
constexpr milliseconds kLongestSilence{10'000};
constexpr milliseconds kFirstPause{250};  // before the next try; up to twice as long at random
constexpr milliseconds kLastPause{2000};
constexpr milliseconds kFirstPauseRejected{1000};
constexpr milliseconds kLastPauseRejected{60'000};
constexpr milliseconds kTurn{500};
constexpr milliseconds kLastWrite{500};    // for what waits when the link ends
constexpr milliseconds kLongestEnd{1000};  // the resolver cannot be interrupted
constexpr std::chrono::minutes kSameLog{1};
constexpr int kRejections = 2;              // nats-server also rejects a key that connects while it reads its users again
constexpr std::size_t kMostWaiting = 4096;  // letters of a subscription
constexpr std::size_t kMostWaitingBytes = 16 * 1024 * 1024;
constexpr std::size_t kRoomBytes = 256 * 1024;
constexpr std::size_t kLeastPayload = 512 * 1024;  // a chunk of a recording and what is around it
constexpr std::size_t kMostOutgoingBytes = 8 * 1024 * 1024;
constexpr int kReadsInATurn = 16;
constexpr std::size_t kReadBytes = 32 * 1024;

bool is_loopback(const std::string& host) { return host == "127.0.0.1" || host == "localhost" || host == "::1"; }

core::Result<std::vector<Address>> addresses_of(const LinkOptions& options) {
  if (options.servers.empty()) return core::fail(core::ErrorCode::InvalidArgument, "no server is named");
  std::vector<Address> addresses;
  for (const std::string& server : options.servers) {
    DTS_TRY_ASSIGN(const Address address, address_of(server));
    if (!address.is_tls && !is_loopback(address.host)) {
      return core::fail(core::ErrorCode::InvalidArgument, "the server '" + server + "' is not tls://HOST:PORT",
                        "without TLS only a server on this machine is possible: nats://127.0.0.1:4222");
    }
    if (address.is_tls && options.ca_pem.empty()) {
      return core::fail(core::ErrorCode::InvalidArgument, "no certificate authority is given for " + server);
    }
    addresses.push_back(address);
  }
  return addresses;
}

/// True for what the server says before it ends a connection whose key it does not accept.
bool is_rejection(std::string_view reason) {
  return reason.starts_with("Authorization Violation") || reason.starts_with("User Authentication") ||
         reason.starts_with("Account Authentication");
}

}  // namespace

/// The letters of one subscription.
struct Mail {
  std::mutex mutex{};
  std::condition_variable changed{};
  std::deque<Letter> letters{};
  std::size_t bytes = 0;
  std::uint64_t dropped = 0;

  void add(Letter letter) {
    const std::lock_guard lock(mutex);
    if (letters.size() >= kMostWaiting || bytes + letter.data.size() > kMostWaitingBytes) {
      ++dropped;
      return;
    }
    bytes += letter.data.size();
    letters.push_back(std::move(letter));
    changed.notify_one();
  }
  std::optional<Letter> next(milliseconds timeout) {
    std::unique_lock lock(mutex);
    if (!changed.wait_for(lock, timeout, [this] { return !letters.empty(); })) return std::nullopt;
    Letter letter = std::move(letters.front());
    letters.pop_front();
    bytes -= letter.data.size();
    return letter;
  }
};

/// What a link, its subscriptions and its thread share.
class Connection {
  template <class Action>
  auto get(Action action) const {
    const std::lock_guard lock(mutex_);
    return action();
  }

 public:
  Connection(const LinkOptions& options, std::vector<Address> addresses, TlsContext tls, core::Log log)
      : name_(options.name),
        seed_(options.seed),
        rejection_(options.rejection),
        addresses_(std::move(addresses)),
        tls_(std::move(tls)),
        log_(std::move(log)) {}

  /// The thread: connects, serves the connection, connects again, until `end`.
  void run();
  /// Asks the thread to end, and waits for it as long as may be. Returns true if it has ended.
  [[nodiscard]] bool end();

  [[nodiscard]] core::Status publish(const Letter& letter);
  [[nodiscard]] std::uint64_t subscribe(const std::string& subject, const std::string& queue, std::shared_ptr<Mail> mail);
  void unsubscribe(std::uint64_t subscription);

  [[nodiscard]] bool is_connected() const {
    return get([this] { return is_connected_; });
  }
  [[nodiscard]] bool has_room() const {
    return get([this] { return is_connected_ && waiting_ < kRoomBytes; });
  }
  [[nodiscard]] bool is_rejected() const {
    return get([this] { return rejections_ >= kRejections; });
  }
  [[nodiscard]] std::uint64_t connections() const {
    return get([this] { return connections_; });
  }
  [[nodiscard]] std::string problem() const {
    return get([this] { return problem_; });
  }

 private:
  struct Wanted {
    std::string subject;
    std::string queue;
    std::shared_ptr<Mail> mail;
  };
  /// What is known of one connection. Thread: of the link.
  struct Present {
    explicit Present(Time now) : heard_at(now), acknowledged_at(now), arrived_at(now), ping_at(now + kPingInterval) {}
    Parser parser{};
    std::string writing{};       ///< Bytes that are written now,
    std::size_t written = 0;     ///< and how many of them are.
    bool has_ping = false;       ///< They end with a ping.
    bool is_ping_out = false;    ///< Its answer has not arrived.
    std::uint64_t ping_end = 0;  ///< Bytes given to TCP when the ping was; 0: it was not yet.
    std::uint64_t acknowledged = 0;
    Time heard_at;         ///< When the server last sent something.
    Time acknowledged_at;  ///< When it last acknowledged something, or had nothing to acknowledge.
    Time arrived_at;       ///< When it had acknowledged the last ping.
    Time ping_at;          ///< When the next is due.
  };

  [[nodiscard]] bool is_ending() const {
    return get([this] { return is_ending_; });
  }
  [[nodiscard]] core::Status serve(const Address& address);
  [[nodiscard]] core::Result<std::unique_ptr<Channel>> connect(const Address& address);
  [[nodiscard]] core::Status greet(const Address& address, Channel& channel, Present& present);
  [[nodiscard]] core::Result<Operation> wait_for(Operation::Kind kind, Channel& channel, Present& present, Time deadline);
  [[nodiscard]] core::Status write_all(std::string_view bytes, Channel& channel, Time deadline);
  [[nodiscard]] core::Status poll(Channel& channel, int events, milliseconds timeout);
  [[nodiscard]] core::Result<milliseconds> left(Time deadline) const;
  [[nodiscard]] core::Status wait(Channel& channel, int events, Time deadline);
  [[nodiscard]] core::Status exchange(Channel& channel, Present& present);
  [[nodiscard]] core::Status write(Channel& channel, Present& present, Time now);
  [[nodiscard]] core::Result<bool> receive(Channel& channel, Present& present);
  [[nodiscard]] core::Status handle(Operation operation, Present& present);
  [[nodiscard]] core::Status check_silence(const Channel& channel, Present& present, Time now) const;
  void set_connected(const ServerInfo& info);
  void set_ended(const core::Error& why);
  void send_line(std::string line);  // behind the mutex
  void pause(std::size_t failures);

  const std::string name_;
  const std::string seed_;
  const std::string rejection_;
  const std::vector<Address> addresses_;
  const TlsContext tls_;
  const core::Log log_;
  core::Doorbell doorbell_{};  ///< Something can be written, or the end is requested.
  core::TokenBucket complaints_{0.1, 5.0};
  Turns turns_{addresses_.size()};  ///< Thread: of the link.

  mutable std::mutex mutex_{};
  std::condition_variable changed_{};
  bool is_ending_ = false;  ///< Behind the mutex, as all that follows.
  bool is_over_ = false;
  bool is_connected_ = false;
  int rejections_ = 0;  ///< Since it was last accepted.
  std::uint64_t connections_ = 0;
  std::string problem_{"not connected yet"};
  std::string logged_{};
  Time logged_at_{};
  std::size_t max_payload_ = 0;
  std::string out_{};        ///< To be written next.
  std::size_t waiting_ = 0;  ///< Bytes that are not yet given to TCP.
  std::uint64_t last_subscription_ = 0;
  std::map<std::uint64_t, Wanted> wanted_{};
};

void Connection::run() {
  sigset_t broken_pipe;
  sigemptyset(&broken_pipe);
  sigaddset(&broken_pipe, SIGPIPE);
  ::pthread_sigmask(SIG_BLOCK, &broken_pipe, nullptr);  // OpenSSL writes without MSG_NOSIGNAL
  (void)core::configure_this_thread("link", {});
  while (!is_ending()) {
    try {
      const auto ended = serve(addresses_[turns_.server()]);
      if (!ended) set_ended(ended.error());
    } catch (const std::exception& error) {
      set_ended({.code = core::ErrorCode::Failed, .what = error.what(), .hint = {}});
    }
    pause(turns_.ended(std::chrono::steady_clock::now()));
  }
  const std::lock_guard lock(mutex_);
  is_over_ = true;
  changed_.notify_all();
}

bool Connection::end() {
  std::unique_lock lock(mutex_);
  is_ending_ = true;
  doorbell_.ring();
  changed_.notify_all();
  return changed_.wait_for(lock, kLongestEnd, [this] { return is_over_; });
}

/// Waits before the next try. `failures`: how often all servers have failed before.
void Connection::pause(std::size_t failures) {
  std::unique_lock lock(mutex_);
  const std::size_t rounds = std::min<std::size_t>(failures, 16);
  const bool is_rejected = rejections_ >= kRejections;
  const milliseconds longest = is_rejected ? kLastPauseRejected : kLastPause;
  const milliseconds whole = std::min((is_rejected ? kFirstPauseRejected : kFirstPause) * (1 << rounds), longest);
  const milliseconds random(randombytes_uniform(static_cast<std::uint32_t>(whole.count()) + 1));
  changed_.wait_for(lock, whole + random, [this] { return is_ending_; });
}

core::Status Connection::publish(const Letter& letter) {
  const std::lock_guard lock(mutex_);
  if (!is_connected_) return core::fail(core::ErrorCode::Unreachable, "no connection to the centre: " + problem_);
  if (!is_subject(letter.subject) || (!letter.reply.empty() && !is_subject(letter.reply))) {
    return core::fail(core::ErrorCode::InvalidArgument, "cannot send to " + letter.subject + ": not a subject");
  }
  if (letter.data.size() > max_payload_) {
    return core::fail(core::ErrorCode::LimitExceeded, "cannot send to " + letter.subject + ": " + std::to_string(letter.data.size()) +
                                                          " bytes, but the server accepts at most " + std::to_string(max_payload_));
  }
  if (waiting_ > kMostOutgoingBytes) {
    return core::fail(core::ErrorCode::Timeout, "cannot send to " + letter.subject + ": the line does not take what waits");
  }
  const std::size_t before = out_.size();
  append_publish(letter, out_);
  waiting_ += out_.size() - before;
  doorbell_.ring();
  return {};
}

void Connection::send_line(std::string line) {
  if (!is_connected_) return;  // all subscriptions are sent when it is
  waiting_ += line.size();
  out_ += line;
  doorbell_.ring();
}

std::uint64_t Connection::subscribe(const std::string& subject, const std::string& queue, std::shared_ptr<Mail> mail) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t subscription = ++last_subscription_;
  wanted_.emplace(subscription, Wanted{.subject = subject, .queue = queue, .mail = std::move(mail)});
  send_line(subscribe_line(subject, queue, subscription));
  return subscription;
}

void Connection::unsubscribe(std::uint64_t subscription) {
  const std::lock_guard lock(mutex_);
  wanted_.erase(subscription);
  send_line(unsubscribe_line(subscription));
}

void Connection::set_connected(const ServerInfo& info) {
  const std::lock_guard lock(mutex_);
  is_connected_ = true;
  rejections_ = 0;
  ++connections_;
  max_payload_ = info.max_payload;
  problem_.clear();
  logged_.clear();
  log_.info(name_ + ": connected");
  for (const auto& [subscription, wanted] : wanted_) send_line(subscribe_line(wanted.subject, wanted.queue, subscription));
}

void Connection::set_ended(const core::Error& why) {
  const std::lock_guard lock(mutex_);
  if (is_ending_) return;
  if (why.code == core::ErrorCode::NotAllowed && rejections_ < kRejections) ++rejections_;
  const bool was_connected = std::exchange(is_connected_, false);
  out_.clear();
  waiting_ = 0;
  if (why.code == core::ErrorCode::NotAllowed) {
    problem_ = "the server rejects the key (" + why.what + ")" + (rejection_.empty() ? "" : ": " + rejection_);
  } else {
    problem_ = (was_connected ? "the connection is lost: " : "no connection: ") + why.what;
  }
  const Time now = std::chrono::steady_clock::now();
  if (problem_ == logged_ || (!was_connected && !logged_.empty() && now - logged_at_ < kSameLog)) return;
  logged_ = problem_;
  logged_at_ = now;
  log_.warning(name_ + ": " + problem_);
}

/// Waits for these events, for a letter to write, or for the end of the timeout.
core::Status Connection::poll(Channel& channel, int events, milliseconds timeout) {
  std::array<pollfd, 2> polled{{{.fd = channel.descriptor(), .events = static_cast<short>(events | channel.events()), .revents = 0},
                                {.fd = doorbell_.fd(), .events = POLLIN, .revents = 0}}};
  if (::poll(polled.data(), polled.size(), static_cast<int>(timeout.count())) < 0 && errno != EINTR) return core::fail_errno(errno, "poll");
  if (polled[1].revents != 0) (void)doorbell_.clear();
  return {};
}

/// Returns how long the server may still take to establish a connection. Fails at the deadline, and if the end is requested.
core::Result<milliseconds> Connection::left(Time deadline) const {
  const auto rest = std::chrono::duration_cast<milliseconds>(deadline - std::chrono::steady_clock::now());
  if (rest <= milliseconds(0)) return core::fail(core::ErrorCode::Timeout, "the server does not answer");
  if (is_ending()) return core::fail(core::ErrorCode::Failed, "stopped");
  return rest;
}

/// The same as `poll` before a connection is established. Fails like `left`.
core::Status Connection::wait(Channel& channel, int events, Time deadline) {
  DTS_TRY_ASSIGN(const milliseconds most, left(deadline));
  return poll(channel, events, std::min(most, kTurn));
}

core::Result<std::unique_ptr<Channel>> Connection::connect(const Address& address) {
  DTS_TRY_ASSIGN(const auto found, find_host(address));
  core::Error why{.code = core::ErrorCode::Unreachable, .what = "no address", .hint = {}};
  for (const SocketAddress& one : found) {
    auto begun = Channel::begin(one);
    if (!begun) {
      why = begun.error();
      continue;
    }
    const Time deadline = std::chrono::steady_clock::now() + kConnectTimeout;
    core::Status waited;
    pollfd polled{.fd = (*begun)->descriptor(), .events = POLLOUT, .revents = 0};
    while (waited && ::poll(&polled, 1, 0) == 0) waited = wait(**begun, POLLOUT, deadline);
    if (waited) waited = (*begun)->connected();
    if (waited) return begun;
    why = waited.error();
  }
  return tl::make_unexpected(why);
}

core::Status Connection::write_all(std::string_view bytes, Channel& channel, Time deadline) {
  while (!bytes.empty()) {
    DTS_TRY_ASSIGN(const std::size_t count, channel.write(bytes));
    bytes.remove_prefix(count);
    if (count == 0) DTS_TRY(wait(channel, POLLIN | POLLOUT, deadline));
  }
  return {};
}

core::Result<Operation> Connection::wait_for(Operation::Kind kind, Channel& channel, Present& present, Time deadline) {
  while (true) {
    DTS_TRY(left(deadline));  // also while the server sends without an end
    DTS_TRY_ASSIGN(auto operation, present.parser.next());
    if (!operation) {
      // One byte at a time before TLS: what comes after the line belongs to TLS.
      std::array<char, 512> bytes{};
      DTS_TRY_ASSIGN(const std::size_t count, channel.read(bytes.data(), kind == Operation::Kind::Info ? 1 : bytes.size()));
      present.parser.append(std::string_view(bytes.data(), count));
      if (count == 0) DTS_TRY(wait(channel, POLLIN, deadline));
      continue;
    }
    if (operation->kind == kind) return std::move(*operation);
    if (kind == Operation::Kind::Info) return core::fail(core::ErrorCode::DataDamaged, "the server does not begin with INFO");
    if (operation->kind == Operation::Kind::Error) {
      return core::fail(is_rejection(operation->text) ? core::ErrorCode::NotAllowed : core::ErrorCode::Unreachable, operation->text);
    }
  }
}

/// The first lines of both sides, until the server has accepted the key.
core::Status Connection::greet(const Address& address, Channel& channel, Present& present) {
  const Time deadline = std::chrono::steady_clock::now() + kConnectTimeout;
  DTS_TRY_ASSIGN(const Operation hello, wait_for(Operation::Kind::Info, channel, present, deadline));
  DTS_TRY_ASSIGN(const ServerInfo info, info_of_json(hello.text));
  if (info.max_payload < kLeastPayload) {  // INFO comes before TLS: anybody on the way can have written it
    return core::fail(core::ErrorCode::Unreachable, "the server accepts only messages of " + std::to_string(info.max_payload) +
                                                        " bytes: max_payload of nats-server must be at least " +
                                                        std::to_string(kLeastPayload));
  }
  if (address.is_tls) {
    DTS_TRY(channel.begin_tls(tls_.get(), address.host));
    while (true) {
      DTS_TRY_ASSIGN(const bool is_done, channel.shake_hands());
      if (is_done) break;
      DTS_TRY(wait(channel, POLLIN, deadline));
    }
  }
  DTS_TRY_ASSIGN(std::string line, connect_line(name_, seed_, info.nonce, address.is_tls));
  DTS_TRY(write_all(line + std::string(kPing), channel, deadline));
  DTS_TRY(wait_for(Operation::Kind::Pong, channel, present, deadline));
  set_connected(info);
  turns_.connected(std::chrono::steady_clock::now());
  return {};
}

core::Status Connection::serve(const Address& address) {
  DTS_TRY_ASSIGN(const auto channel, connect(address));
  Present present(std::chrono::steady_clock::now());
  DTS_TRY(greet(address, *channel, present));
  return exchange(*channel, present);
}

core::Status Connection::exchange(Channel& channel, Present& present) {
  std::optional<Time> end_at;
  present.heard_at = present.acknowledged_at = std::chrono::steady_clock::now();
  Time checked_at{};
  while (true) {
    DTS_TRY(write(channel, present, std::chrono::steady_clock::now()));
    DTS_TRY_ASSIGN(const bool has_more, receive(channel, present));
    const Time now = std::chrono::steady_clock::now();
    if (now - checked_at >= kTurn) {
      checked_at = now;
      DTS_TRY(check_silence(channel, present, now));
    }
    const auto [is_end, is_empty] = get([this] { return std::pair(is_ending_, out_.empty()); });
    const bool is_writing = present.written < present.writing.size() || !is_empty;
    if (is_end) {
      if (!end_at) end_at = now + kLastWrite;
      if (!is_writing || now >= *end_at) return {};
    }
    DTS_TRY(poll(channel, POLLIN | (present.written < present.writing.size() ? POLLOUT : 0), has_more ? milliseconds(0) : kTurn));
  }
}

core::Status Connection::write(Channel& channel, Present& present, Time now) {
  while (true) {
    if (present.written == present.writing.size()) {
      present.writing.clear();
      present.written = 0;
      const std::lock_guard lock(mutex_);
      std::swap(present.writing, out_);
      present.has_ping = !present.is_ping_out && now >= present.ping_at;
      if (present.has_ping) {
        present.writing += kPing;
        waiting_ += kPing.size();
        present.is_ping_out = true;
        present.ping_end = 0;
      }
    }
    if (present.writing.empty()) return {};
    DTS_TRY_ASSIGN(const std::size_t count, channel.write(std::string_view(present.writing).substr(present.written)));
    if (count == 0) return {};
    present.written += count;
    {
      const std::lock_guard lock(mutex_);
      waiting_ -= std::min(waiting_, count);
    }
    if (present.written == present.writing.size() && present.has_ping) present.ping_end = channel.written();
  }
}

core::Result<bool> Connection::receive(Channel& channel, Present& present) {
  std::array<char, kReadBytes> bytes;  // NOLINT(*-member-init): `count` of them are written
  for (int reads = 0; reads < kReadsInATurn; ++reads) {
    DTS_TRY_ASSIGN(const std::size_t count, channel.read(bytes.data(), bytes.size()));
    if (count == 0) return false;
    present.heard_at = std::chrono::steady_clock::now();
    present.parser.append(std::string_view(bytes.data(), count));
    while (true) {
      DTS_TRY_ASSIGN(auto operation, present.parser.next());
      if (!operation) break;
      DTS_TRY(handle(std::move(*operation), present));
    }
  }
  return true;
}

core::Status Connection::handle(Operation operation, Present& present) {
  switch (operation.kind) {
    case Operation::Kind::Message: {
      const auto mail = get([this, &operation] {
        const auto found = wanted_.find(operation.subscription);
        return found == wanted_.end() ? nullptr : found->second.mail;
      });
      if (mail != nullptr) mail->add(std::move(operation.letter));  // otherwise it has ended meanwhile
      return {};
    }
    case Operation::Kind::Ping: {
      const std::lock_guard lock(mutex_);
      send_line(std::string(kPong));
      return {};
    }
    case Operation::Kind::Pong:
      present.is_ping_out = false;
      present.ping_at = std::chrono::steady_clock::now() + kPingInterval;
      return {};
    case Operation::Kind::Error:
      if (operation.text.starts_with("Permissions Violation")) {  // the connection continues
        if (complaints_.take(std::chrono::steady_clock::now())) log_.warning(name_ + ": " + operation.text);
        return {};
      }
      return core::fail(is_rejection(operation.text) ? core::ErrorCode::NotAllowed : core::ErrorCode::Unreachable, operation.text);
    case Operation::Kind::Info:
    case Operation::Kind::Ok: return {};
  }
  return {};
}

/// Fails if the line is dead although nothing has ended the connection: the server's TCP acknowledges nothing of what waits, or no answer
/// comes to a ping that has arrived. A slow line is not dead: a ping behind many bytes arrives late.
core::Status Connection::check_silence(const Channel& channel, Present& present, Time now) const {
  const std::uint64_t unacknowledged = channel.unacknowledged();
  const std::uint64_t acknowledged = channel.written() - std::min(channel.written(), unacknowledged);
  if (acknowledged != present.acknowledged || (unacknowledged == 0 && present.written == present.writing.size()))
    present.acknowledged_at = now;
  present.acknowledged = acknowledged;
  const bool has_arrived = present.is_ping_out && present.ping_end != 0 && acknowledged >= present.ping_end;
  if (!has_arrived) present.arrived_at = now;
  if (now - present.acknowledged_at > kLongestSilence || now - std::max(present.arrived_at, present.heard_at) > kLongestSilence) {
    return core::fail(core::ErrorCode::Timeout, "the server is silent");
  }
  return {};
}

class Subscription::Implementation {
 public:
  Implementation(std::shared_ptr<Connection> of, std::shared_ptr<Mail> letters, std::uint64_t subscription)
      : connection(std::move(of)), mail(std::move(letters)), number(subscription) {}
  ~Implementation() { connection->unsubscribe(number); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  std::shared_ptr<Connection> connection;
  std::shared_ptr<Mail> mail;
  std::uint64_t number;
};

Subscription::Subscription(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Subscription::~Subscription() = default;

std::optional<Letter> Subscription::next(milliseconds timeout) { return implementation_->mail->next(timeout); }

std::uint64_t Subscription::dropped() const {
  const std::lock_guard lock(implementation_->mail->mutex);
  return implementation_->mail->dropped;
}

class Link::Implementation {
 public:
  Implementation(std::shared_ptr<Connection> opened, std::string prefix)
      : connection(std::move(opened)), inbox_prefix(std::move(prefix)), thread([own = connection] { own->run(); }) {}
  ~Implementation() {
    if (connection->end()) {
      thread.join();
    } else {
      thread.detach();  // it waits for the resolver, and owns what it uses
    }
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  std::shared_ptr<Connection> connection;
  std::string inbox_prefix;
  std::thread thread;
};

Link::Link(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Link::~Link() = default;

core::Result<std::unique_ptr<Link>> Link::open(const LinkOptions& options, const core::Log& log) {
  DTS_TRY_ASSIGN(auto addresses, addresses_of(options));
  if (!options.seed.empty()) DTS_TRY(wire::nkey_of_seed(options.seed));
  TlsContext tls;
  if (std::ranges::any_of(addresses, &Address::is_tls)) {
    DTS_TRY_ASSIGN(tls, make_tls_context(options.ca_pem));
  }
  auto connection = std::make_shared<Connection>(options, std::move(addresses), std::move(tls), log);
  const std::string prefix = options.inbox_prefix.empty() ? "_INBOX" : options.inbox_prefix;
  return std::unique_ptr<Link>(new Link(std::make_unique<Implementation>(std::move(connection), prefix)));
}

core::Status Link::publish(const Letter& letter) { return implementation_->connection->publish(letter); }

core::Result<std::string> Link::request(const std::string& subject, std::string_view data, milliseconds timeout) {
  const std::string inbox = new_inbox();
  DTS_TRY_ASSIGN(const auto answers, subscribe(inbox));
  DTS_TRY(publish({.subject = subject, .reply = inbox, .data = std::string(data)}));
  auto letter = answers->next(timeout);
  if (!letter) return core::fail(core::ErrorCode::Timeout, "no answer to " + subject);
  if (letter->has_no_listener) return core::fail(core::ErrorCode::Unreachable, "no answer to " + subject + ": nobody listens");
  return std::move(letter->data);
}

core::Result<std::unique_ptr<Subscription>> Link::subscribe(const std::string& subject, const std::string& queue) {
  if (!is_subject(subject) || (!queue.empty() && !is_subject(queue))) {
    return core::fail(core::ErrorCode::InvalidArgument, "cannot subscribe to " + subject + ": not a subject");
  }
  auto mail = std::make_shared<Mail>();
  const std::uint64_t number = implementation_->connection->subscribe(subject, queue, mail);
  return std::unique_ptr<Subscription>(
      new Subscription(std::make_unique<Subscription::Implementation>(implementation_->connection, std::move(mail), number)));
}

std::string Link::new_inbox() const {
  std::array<unsigned char, 16> bytes{};
  randombytes_buf(bytes.data(), bytes.size());
  std::array<char, 2 * bytes.size() + 1> text{};
  sodium_bin2hex(text.data(), text.size(), bytes.data(), bytes.size());
  return implementation_->inbox_prefix + "." + text.data();
}

bool Link::is_connected() const { return implementation_->connection->is_connected(); }
bool Link::has_room() const { return implementation_->connection->has_room(); }
bool Link::is_rejected() const { return implementation_->connection->is_rejected(); }
std::uint64_t Link::connections() const { return implementation_->connection->connections(); }
std::string Link::problem() const { return implementation_->connection->problem(); }

}  // namespace dts::fleet::link
