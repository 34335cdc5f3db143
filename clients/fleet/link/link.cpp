// SPDX-License-Identifier: Apache-2.0
#include "fleet/link/link.h"

#include <nats/nats.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "fleet/wire/nkey.h"

namespace dts::fleet::link {

template <auto destroy>
struct Destroyer {
  template <class T>
  void operator()(T* object) const noexcept {
    destroy(object);
  }
};
using Options = std::unique_ptr<natsOptions, Destroyer<natsOptions_Destroy>>;
using Message = std::unique_ptr<natsMsg, Destroyer<natsMsg_Destroy>>;
using Connection = std::unique_ptr<natsConnection, Destroyer<natsConnection_Destroy>>;
using NatsSubscription = std::unique_ptr<natsSubscription, Destroyer<natsSubscription_Destroy>>;

namespace {

constexpr std::int64_t kReconnectWaitMs = 250;
constexpr std::int64_t kReconnectJitterMs = 250;
constexpr std::int64_t kPingIntervalMs = 5000;  // a dead link is noticed after three of these
constexpr int kMostPingsOut = 2;
constexpr std::int64_t kConnectTimeoutMs = 5000;
constexpr int kMostWaiting = 4096;
constexpr int kMostWaitingBytes = 16 * 1024 * 1024;
constexpr std::chrono::milliseconds kLongestClose{2000};

core::ErrorCode code_of(natsStatus status) noexcept {
  switch (status) {
    case NATS_TIMEOUT: return core::ErrorCode::Timeout;
    case NATS_MAX_PAYLOAD: return core::ErrorCode::LimitExceeded;
    case NATS_INVALID_ARG:
    case NATS_INVALID_SUBJECT: return core::ErrorCode::InvalidArgument;
    case NATS_CONNECTION_AUTH_FAILED:
    case NATS_NOT_PERMITTED: return core::ErrorCode::NotAllowed;
    case NATS_CONNECTION_CLOSED:
    case NATS_CONNECTION_DISCONNECTED:
    case NATS_NOT_YET_CONNECTED:
    case NATS_NO_SERVER:
    case NATS_NO_RESPONDERS: return core::ErrorCode::Unreachable;
    default: return core::ErrorCode::Failed;
  }
}

tl::unexpected<core::Error> failed(natsStatus status, const std::string& what) {
  return core::fail(code_of(status), what + ": " + natsStatus_GetText(status));
}

core::Status check(natsStatus status, const std::string& what) {
  if (status != NATS_OK) return failed(status, what);
  return {};
}

bool is_loopback(std::string_view server) {
  return server.starts_with("nats://127.0.0.1:") || server.starts_with("nats://localhost:") || server.starts_with("nats://[::1]:");
}

core::Status check_servers(const LinkOptions& options) {
  if (options.servers.empty()) return core::fail(core::ErrorCode::InvalidArgument, "no server is named");
  for (const std::string& server : options.servers) {
    const bool is_tls = server.starts_with("tls://");
    if (!is_tls && !is_loopback(server)) {
      return core::fail(core::ErrorCode::InvalidArgument, "the server '" + server + "' is not tls://HOST:PORT",
                        "without TLS only a server on this machine is possible: nats://127.0.0.1:4222");
    }
    if (is_tls != options.servers.front().starts_with("tls://")) {
      return core::fail(core::ErrorCode::InvalidArgument, "some servers have TLS and some do not");
    }
    if (is_tls && options.ca_pem.empty()) {
      return core::fail(core::ErrorCode::InvalidArgument, "no certificate authority is given for " + server);
    }
  }
  return {};
}

Letter letter_of(const Message& message) {
  const char* const reply = natsMsg_GetReply(message.get());
  return {.subject = natsMsg_GetSubject(message.get()),
          .reply = reply == nullptr ? std::string() : std::string(reply),
          .data = std::string(natsMsg_GetData(message.get()), static_cast<std::size_t>(natsMsg_GetDataLength(message.get())))};
}

}  // namespace

/// What libnats's threads report. They may call until `on_closed`, which is the last call.
struct Reports {
  Reports(core::Log to, std::string of, std::string key) : log(std::move(to)), name(std::move(of)), seed(std::move(key)) {}

  core::Log log;
  std::string name;
  std::string seed;
  std::atomic<std::uint64_t> connections{0};
  std::mutex mutex{};
  std::condition_variable changed{};
  std::string problem{"not connected yet"};
  bool is_closed = false;
  bool is_ending = false;

  void set_problem(std::string text) {
    const std::lock_guard lock(mutex);
    if (!is_ending && text != problem) {
      if (text.empty()) {
        log.info(name + ": connected");
      } else {
        log.warning(name + ": " + text);
      }
    }
    problem = std::move(text);
  }
};

namespace {

using SharedReports = std::shared_ptr<Reports>;

Reports& reports(void* closure) noexcept { return **static_cast<SharedReports*>(closure); }

std::string last_error(natsConnection* connection) {
  const char* text = nullptr;
  natsConnection_GetLastError(connection, &text);
  return text == nullptr || *text == '\0' ? std::string("no connection") : std::string(text);
}

void on_connected(natsConnection* /*connection*/, void* closure) {
  ++reports(closure).connections;
  reports(closure).set_problem({});
}

void on_disconnected(natsConnection* connection, void* closure) {
  reports(closure).set_problem("the connection is lost: " + last_error(connection));
}

void on_closed(natsConnection* connection, void* closure) {
  const std::unique_ptr<SharedReports> own(static_cast<SharedReports*>(closure));
  Reports& own_reports = **own;
  own_reports.set_problem("the server rejects the connection: " + last_error(connection));
  const std::lock_guard lock(own_reports.mutex);
  own_reports.is_closed = true;
  own_reports.changed.notify_all();
}

void on_error(natsConnection* connection, natsSubscription* /*subscription*/, natsStatus status, void* closure) {
  reports(closure).log.warning(reports(closure).name + ": " + natsStatus_GetText(status) + ": " + last_error(connection));
}

natsStatus sign(char** error, unsigned char** signature, int* length, const char* nonce, void* closure) {
  *error = nullptr;
  return nats_Sign(reports(closure).seed.c_str(), nonce, signature, length);
}

natsStatus set_options(natsOptions* options, const LinkOptions& wanted, void* closure, const std::string& public_key) {
  std::vector<const char*> servers;
  servers.reserve(wanted.servers.size());
  for (const std::string& server : wanted.servers) servers.push_back(server.c_str());
  natsStatus status = natsOptions_SetServers(options, servers.data(), static_cast<int>(servers.size()));
  const auto then = [&status](natsStatus next) {
    if (status == NATS_OK) status = next;
  };
  if (wanted.servers.front().starts_with("tls://")) {
    then(natsOptions_SetSecure(options, true));
    then(natsOptions_SetCATrustedCertificates(options, wanted.ca_pem.c_str()));
  }
  then(natsOptions_SetName(options, wanted.name.c_str()));
  if (!wanted.seed.empty()) then(natsOptions_SetNKey(options, public_key.c_str(), sign, closure));
  if (!wanted.inbox_prefix.empty()) then(natsOptions_SetCustomInboxPrefix(options, wanted.inbox_prefix.c_str()));
  then(natsOptions_SetTimeout(options, kConnectTimeoutMs));
  then(natsOptions_SetMaxReconnect(options, -1));
  then(natsOptions_SetReconnectWait(options, kReconnectWaitMs));
  then(natsOptions_SetReconnectJitter(options, kReconnectJitterMs, kReconnectJitterMs));
  then(natsOptions_SetPingInterval(options, kPingIntervalMs));
  then(natsOptions_SetMaxPingsOut(options, kMostPingsOut));
  then(natsOptions_SetRetryOnFailedConnect(options, true, on_connected, closure));
  then(natsOptions_SetReconnectedCB(options, on_connected, closure));
  then(natsOptions_SetDisconnectedCB(options, on_disconnected, closure));
  then(natsOptions_SetClosedCB(options, on_closed, closure));
  then(natsOptions_SetErrorHandler(options, on_error, closure));
  return status;
}

}  // namespace

class Subscription::Implementation {
 public:
  explicit Implementation(NatsSubscription opened) noexcept : subscription(std::move(opened)) {}
  NatsSubscription subscription;
};

Subscription::Subscription(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Subscription::~Subscription() = default;

std::optional<Letter> Subscription::next(std::chrono::milliseconds timeout) {
  natsMsg* received = nullptr;
  const natsStatus status = natsSubscription_NextMsg(&received, implementation_->subscription.get(), timeout.count());
  if (status == NATS_OK) return letter_of(Message(received));
  // A closed connection fails at once; a caller that asks again in a loop must not use a whole core.
  const bool can_go_on = status == NATS_TIMEOUT || status == NATS_SLOW_CONSUMER || status == NATS_NO_RESPONDERS;
  if (!can_go_on) std::this_thread::sleep_for(timeout);
  return std::nullopt;
}

std::uint64_t Subscription::dropped() const {
  std::int64_t count = 0;
  if (natsSubscription_GetDropped(implementation_->subscription.get(), &count) != NATS_OK) return 0;
  return static_cast<std::uint64_t>(count);
}

class Link::Implementation {
 public:
  Implementation(SharedReports shared, Connection opened, std::string prefix)
      : reports(std::move(shared)), connection(std::move(opened)), inbox_prefix(std::move(prefix)) {}
  ~Implementation() {
    {
      const std::lock_guard lock(reports->mutex);
      reports->is_ending = true;
    }
    natsConnection_Close(connection.get());
    std::unique_lock lock(reports->mutex);
    reports->changed.wait_for(lock, kLongestClose, [this] { return reports->is_closed; });
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  SharedReports reports;
  Connection connection;
  std::string inbox_prefix;
};

Link::Link(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Link::~Link() = default;

core::Result<std::unique_ptr<Link>> Link::open(const LinkOptions& wanted, const core::Log& log) {
  DTS_TRY(check_servers(wanted));
  std::string public_key;
  if (!wanted.seed.empty()) {
    DTS_TRY_ASSIGN(const wire::NKey key, wire::nkey_of_seed(wanted.seed));
    public_key = key.public_key;
  }
  natsOptions* made = nullptr;
  DTS_TRY(check(natsOptions_Create(&made), "cannot prepare a connection"));
  const Options options(made);
  auto shared = std::make_shared<Reports>(log, wanted.name, wanted.seed);
  auto closure = std::make_unique<SharedReports>(shared);
  DTS_TRY(check(set_options(options.get(), wanted, closure.get(), public_key), "cannot connect to " + wanted.servers.front()));
  natsConnection* opened = nullptr;
  const natsStatus status = natsConnection_Connect(&opened, options.get());
  if (status != NATS_OK && status != NATS_NOT_YET_CONNECTED) return failed(status, "cannot connect to " + wanted.servers.front());
  if (status == NATS_OK) on_connected(opened, closure.get());  // libnats reports only a connection that it made later
  static_cast<void>(closure.release());                        // on_closed deletes it
  return std::unique_ptr<Link>(new Link(std::make_unique<Implementation>(std::move(shared), Connection(opened),
                                                                         wanted.inbox_prefix.empty() ? "_INBOX" : wanted.inbox_prefix)));
}

core::Status Link::publish(const Letter& letter) {
  if (!is_connected()) return core::fail(core::ErrorCode::Unreachable, "no connection to the centre: " + problem());
  natsConnection* const connection = implementation_->connection.get();
  const int length = static_cast<int>(letter.data.size());
  return check(letter.reply.empty()
                   ? natsConnection_Publish(connection, letter.subject.c_str(), letter.data.data(), length)
                   : natsConnection_PublishRequest(connection, letter.subject.c_str(), letter.reply.c_str(), letter.data.data(), length),
               "cannot send to " + letter.subject);
}

core::Result<std::string> Link::request(const std::string& subject, std::string_view data, std::chrono::milliseconds timeout) {
  if (!is_connected()) return core::fail(core::ErrorCode::Unreachable, "no connection to the centre: " + problem());
  natsMsg* received = nullptr;
  DTS_TRY(check(natsConnection_Request(&received, implementation_->connection.get(), subject.c_str(), data.data(),
                                       static_cast<int>(data.size()), timeout.count()),
                "no answer to " + subject));
  return letter_of(Message(received)).data;
}

core::Result<std::unique_ptr<Subscription>> Link::subscribe(const std::string& subject, const std::string& queue) {
  natsSubscription* made = nullptr;
  natsConnection* const connection = implementation_->connection.get();
  DTS_TRY(check(queue.empty() ? natsConnection_SubscribeSync(&made, connection, subject.c_str())
                              : natsConnection_QueueSubscribeSync(&made, connection, subject.c_str(), queue.c_str()),
                "cannot subscribe to " + subject));
  NatsSubscription subscription(made);
  DTS_TRY(check(natsSubscription_SetPendingLimits(made, kMostWaiting, kMostWaitingBytes), "cannot subscribe to " + subject));
  return std::unique_ptr<Subscription>(new Subscription(std::make_unique<Subscription::Implementation>(std::move(subscription))));
}

std::string Link::new_inbox() const {
  natsInbox* made = nullptr;
  if (natsInbox_Create(&made) != NATS_OK) throw std::bad_alloc();  // its only failure
  const std::unique_ptr<natsInbox, Destroyer<natsInbox_Destroy>> inbox(made);
  const std::string_view text(inbox.get());  // "_INBOX.UNIQUE", whatever the connection's prefix is
  return implementation_->inbox_prefix + std::string(text.substr(text.find('.')));
}

bool Link::is_connected() const { return natsConnection_Status(implementation_->connection.get()) == NATS_CONN_STATUS_CONNECTED; }

bool Link::is_rejected() const {
  const std::lock_guard lock(implementation_->reports->mutex);
  return implementation_->reports->is_closed;
}

std::uint64_t Link::connections() const { return implementation_->reports->connections; }

std::string Link::problem() const {
  const std::lock_guard lock(implementation_->reports->mutex);
  return implementation_->reports->problem;
}

}  // namespace dts::fleet::link
