// SPDX-License-Identifier: Apache-2.0
#include "ipc/local_publisher.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "dts/zmtp/zmtp.h"
#include "ipc/endpoint.h"

namespace dts::ipc {
namespace {

constexpr std::string_view kScheme = "ipc://";
constexpr int kBacklog = 64;
constexpr std::size_t kEventsPerTurn = 16;  // and so peers whose input is read in one turn
constexpr int kAcceptsPerTurn = 16;
constexpr std::size_t kBytesPerTurn = 1024;  ///< Read from one peer: some hundred subscriptions.
constexpr std::size_t kLongestFrame = 512;   ///< From a peer: READY with its properties, or a subscription.
constexpr std::size_t kKeptCapacity = std::size_t{64} << 10U;

int process_of(int fd) noexcept {
  ucred peer{};
  socklen_t size = sizeof peer;
  return ::getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 ? peer.pid : 0;
}

bool control(int epoll, int operation, int fd, std::uint32_t wanted) noexcept {
  epoll_event event{.events = wanted, .data = {.fd = fd}};
  return ::epoll_ctl(epoll, operation, fd, &event) == 0;
}

std::string_view text_of(std::span<const std::byte> bytes) noexcept { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

/// Returns a listening socket, or -1 with `errno`.
int listen_at(const std::string& path) noexcept {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof address.sun_path - 1);  // check_endpoint has checked its length
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -1;
  ::unlink(path.c_str());  // of an earlier run: check_not_in_use has seen that nobody listens there
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 && ::listen(fd, kBacklog) == 0) return fd;
  const int reason = errno;
  ::close(fd);
  errno = reason;
  return -1;
}

}  // namespace

core::Result<std::unique_ptr<LocalPublisher>> LocalPublisher::bind(const std::string& endpoint, const core::Clock& clock, core::Log log) {
  DTS_TRY(check_endpoint(endpoint));
  DTS_TRY(check_not_in_use(endpoint));
  const int listener = listen_at(endpoint.substr(kScheme.size()));
  if (listener < 0) return core::fail_errno(errno, "data socket " + endpoint + " cannot be bound", bind_hint(errno));
  const int epoll = ::epoll_create1(EPOLL_CLOEXEC);
  std::unique_ptr<LocalPublisher> publisher(new LocalPublisher(listener, epoll, clock, std::move(log)));
  if (epoll < 0 || !control(epoll, EPOLL_CTL_ADD, listener, EPOLLIN)) {
    return core::fail_errno(errno, "data socket " + endpoint + " cannot be served");
  }
  return publisher;
}

/// Gives subscribers 200 ms to read the last events.
LocalPublisher::~LocalPublisher() {
  const auto is_waiting = [](const auto& entry) { return !entry.second.out.empty(); };
  for (int turn = 0; turn < 20 && std::ranges::any_of(peers_, is_waiting); ++turn) {
    if (turn > 0) ::usleep(10'000);
    for (auto& [fd, peer] : peers_) write(peer);
  }
  for (const auto& [fd, peer] : peers_) ::close(fd);
  ::close(listener_);
  if (epoll_ >= 0) ::close(epoll_);
}

void LocalPublisher::watch(int fd) { static_cast<void>(control(epoll_, EPOLL_CTL_ADD, fd, EPOLLIN)); }

void LocalPublisher::wait(int bell_fd, int timeout_ms) {
  if (bell_fd_ != bell_fd) {
    bell_fd_ = bell_fd;
    watch(bell_fd);
  }
  events_.resize(kEventsPerTurn);
  const int count = ::epoll_wait(epoll_, events_.data(), static_cast<int>(events_.size()), timeout_ms);
  events_.resize(static_cast<std::size_t>(std::max(count, 0)));
}

bool LocalPublisher::take_subscriptions() {
  bool has_new = false;
  for (const epoll_event& event : std::exchange(events_, {})) {
    const int fd = event.data.fd;
    if (fd == listener_) accept_peers();
    const auto found = peers_.find(fd);
    if (found == peers_.end()) continue;
    Peer& peer = found->second;
    if ((event.events & EPOLLOUT) != 0) write(peer);
    const bool has_ended = (event.events & (EPOLLHUP | EPOLLERR)) != 0;
    if (!has_ended && (event.events & EPOLLIN) == 0) continue;
    const Outcome outcome = has_ended ? Outcome::Leave : read(peer);
    if (outcome != Outcome::Leave && !peer.is_blocked && !peer.out.empty()) write(peer);  // answers to pings
    has_new |= outcome == Outcome::NewSubscription;
    if (outcome == Outcome::Leave) leave(fd);
  }
  if (handshakes_ > 0) leave_late_handshakes();
  return has_new;
}

void LocalPublisher::accept_peers() {
  for (int turn = 0; turn < kAcceptsPerTurn; ++turn) {
    const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) {
      // Without a free descriptor the listener stays readable; it would wake this thread all the time.
      if (errno == EMFILE || errno == ENFILE) is_listening_ = !control(epoll_, EPOLL_CTL_DEL, listener_, 0);
      return;
    }
    const int pid = process_of(fd);
    const auto of_process = std::ranges::count_if(peers_, [pid](const auto& entry) { return entry.second.pid == pid; });
    const bool has_room = peers_.size() < kMostPeers && static_cast<std::size_t>(of_process) < kMostPeersOfAProcess;
    if (!has_room || !control(epoll_, EPOLL_CTL_ADD, fd, EPOLLIN)) {
      ::close(fd);
      warn_once(has_warned_of_peers_, "the data socket rejects connections: it serves " + std::to_string(kMostPeers) + ", and " +
                                          std::to_string(kMostPeersOfAProcess) + " of one process; end clients that are not needed");
      continue;
    }
    Peer& peer = peers_[fd];
    peer.fd = fd;
    peer.pid = pid;
    peer.handshake_until_ns = clock_.now_ns() + kHandshakeNs;
    ++handshakes_;
    peer.out = zmtp::greeting();
    zmtp::append_ready(peer.out, "XPUB");
    write(peer);
  }
}

void LocalPublisher::leave(int fd) {
  const auto peer = peers_.find(fd);
  if (peer == peers_.end()) return;
  if (peer->second.state != State::Open) --handshakes_;
  ::close(fd);  // which removes it from epoll
  peers_.erase(peer);
  if (!is_listening_) is_listening_ = control(epoll_, EPOLL_CTL_ADD, listener_, EPOLLIN);
}

void LocalPublisher::leave_late_handshakes() {
  const std::int64_t now_ns = clock_.now_ns();
  std::vector<int> late;
  for (const auto& [fd, peer] : peers_) {
    if (peer.state != State::Open && now_ns > peer.handshake_until_ns) late.push_back(fd);
  }
  for (const int fd : late) leave(fd);
}

/// A peer that is gone is left at its next event (EPOLLHUP), so that nobody's iterator breaks here.
void LocalPublisher::write(Peer& peer) {
  while (peer.written < peer.out.size()) {
    const ssize_t sent = ::send(peer.fd, peer.out.data() + peer.written, peer.out.size() - peer.written, MSG_NOSIGNAL);
    if (sent > 0) {
      peer.written += static_cast<std::size_t>(sent);
      continue;
    }
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0 && errno == EAGAIN) {
      if (peer.written >= kKeptCapacity) peer.out.erase(0, std::exchange(peer.written, 0));
      return watch_for_room(peer, true);
    }
    ::shutdown(peer.fd, SHUT_RDWR);  // a frame may be cut: the connection ends, and EPOLLHUP follows
    break;
  }
  peer.written = 0;
  peer.out.clear();
  if (peer.out.capacity() > kKeptCapacity) peer.out.shrink_to_fit();
  watch_for_room(peer, false);
}

void LocalPublisher::watch_for_room(Peer& peer, bool is_blocked) {
  if (peer.is_blocked == is_blocked) return;
  peer.is_blocked = is_blocked;
  static_cast<void>(control(epoll_, EPOLL_CTL_MOD, peer.fd, EPOLLIN | (is_blocked ? EPOLLOUT : 0U)));
}

LocalPublisher::Outcome LocalPublisher::read(Peer& peer) {
  std::array<char, kBytesPerTurn> bytes{};
  const ssize_t count = ::recv(peer.fd, bytes.data(), bytes.size(), 0);
  if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return Outcome::Leave;
  if (count < 0) return Outcome::Fine;
  peer.in.append(bytes.data(), static_cast<std::size_t>(count));
  return process(peer);
}

/// Processes what has arrived and keeps an incomplete frame, which has at most `kLongestFrame` bytes.
LocalPublisher::Outcome LocalPublisher::process(Peer& peer) {
  std::span<const std::byte> bytes = std::as_bytes(std::span(peer.in));
  Outcome outcome = peer.state == State::Open ? Outcome::Fine : shake_hands(peer, bytes);
  while (outcome != Outcome::Leave && peer.state == State::Open) {
    const zmtp::FrameResult result = zmtp::next_frame(bytes, kLongestFrame);
    const auto* frame = std::get_if<std::optional<zmtp::Frame>>(&result);
    if (frame == nullptr) return Outcome::Leave;
    if (!*frame) break;
    const std::string_view body = text_of((*frame)->body);
    bytes = bytes.subspan((*frame)->size);
    Outcome of_frame = Outcome::Fine;
    if ((*frame)->is_command) {
      of_frame = obey(peer, (*frame)->body);
    } else {
      const bool is_alone = !peer.is_skipping && !(*frame)->has_more;
      peer.is_skipping = (*frame)->has_more;
      const bool is_subscription = is_alone && !body.empty() && (body[0] == '\0' || body[0] == '\1');
      if (is_subscription) of_frame = change_subscription(peer, body[0] == '\1', body.substr(1));
    }
    if (of_frame != Outcome::Fine) outcome = of_frame;
  }
  if (outcome == Outcome::Leave) return outcome;
  peer.in.erase(0, peer.in.size() - bytes.size());
  return outcome;
}

LocalPublisher::Outcome LocalPublisher::shake_hands(Peer& peer, std::span<const std::byte>& bytes) {
  if (peer.state == State::Greeting) {
    if (!zmtp::fault_of_greeting(bytes).empty()) return Outcome::Leave;
    if (bytes.size() < zmtp::kGreetingBytes) return Outcome::Fine;
    bytes = bytes.subspan(zmtp::kGreetingBytes);
    peer.state = State::Handshake;
  }
  const zmtp::FrameResult result = zmtp::next_frame(bytes, kLongestFrame);
  const auto* frame = std::get_if<std::optional<zmtp::Frame>>(&result);
  if (frame != nullptr && !*frame) return Outcome::Fine;
  const auto command = frame != nullptr && (*frame)->is_command ? zmtp::command_of((*frame)->body) : std::nullopt;
  const auto type = command && command->name == "READY" ? zmtp::property_of(command->data, "Socket-Type") : std::nullopt;
  if (!type || (*type != "SUB" && *type != "XSUB")) return Outcome::Leave;
  bytes = bytes.subspan((*frame)->size);
  peer.state = State::Open;
  --handshakes_;
  return Outcome::Fine;
}

/// Commands of an open connection. Peers of ZMTP 3.1 may send subscriptions as commands; unknown commands are ignored, as ZMTP demands.
LocalPublisher::Outcome LocalPublisher::obey(Peer& peer, std::span<const std::byte> body) {
  const auto command = zmtp::command_of(body);
  if (!command || command->name == "ERROR") return Outcome::Leave;
  if (command->name == "SUBSCRIBE" || command->name == "CANCEL")
    return change_subscription(peer, command->name == "SUBSCRIBE", command->data);
  if (command->name == "PING" && peer.out.size() - peer.written < kQueueBytes) {
    zmtp::append_pong(peer.out, command->data);
  }
  return Outcome::Fine;
}

LocalPublisher::Outcome LocalPublisher::change_subscription(Peer& peer, bool is_new, std::string_view prefix) {
  peer.matches.clear();
  if (!is_new) {
    if (const auto found = peer.prefixes.find(prefix); found != peer.prefixes.end()) peer.prefixes.erase(found);
    return Outcome::Fine;
  }
  const bool has_room = prefix.size() <= kLongestPrefix && (peer.prefixes.size() < kMostSubscriptions || peer.prefixes.contains(prefix));
  if (!has_room) {
    warn_once(has_warned_of_subscriptions_, "a client of the data socket (process " + std::to_string(peer.pid) +
                                                ") was disconnected: a client may have " + std::to_string(kMostSubscriptions) +
                                                " subscriptions of up to " + std::to_string(kLongestPrefix) + " bytes");
    return Outcome::Leave;
  }
  peer.prefixes.emplace(prefix);
  return Outcome::NewSubscription;
}

bool LocalPublisher::matches(Peer& peer, const std::string& topic) {
  if (const auto known = peer.matches.find(topic); known != peer.matches.end()) return known->second;
  bool is_match = false;
  for (std::size_t size = 0; size <= topic.size() && !is_match; ++size) {
    is_match = peer.prefixes.contains(std::string_view(topic).substr(0, size));
  }
  peer.matches.emplace(topic, is_match);  // bounded: the daemon has some dozens of topics
  return is_match;
}

void LocalPublisher::send(std::string_view topic, const google::protobuf::MessageLite& message) {
  topic_ = topic;
  frames_.clear();
  for (auto& [fd, peer] : peers_) {
    if (peer.state != State::Open || !matches(peer, topic_)) continue;
    if (frames_.empty()) {  // encoded once, for the first subscriber
      zmtp::append_frame(frames_, topic_, true);
      body_.clear();
      if (!message.AppendToString(&body_)) return;
      zmtp::append_frame(frames_, body_);
    }
    if (!peer.is_blocked && peer.out.size() + frames_.size() > kQueueBytes) write(peer);
    const std::size_t waiting = peer.out.size() - peer.written;
    if (waiting > 0 && waiting + frames_.size() > kQueueBytes) {
      ++dropped_;
    } else {
      queue(peer, frames_);
    }
  }
}

bool LocalPublisher::flush(std::size_t most_peers) {
  for (auto& [fd, peer] : peers_) {
    if (peer.out.empty() || peer.is_blocked) continue;
    if (most_peers-- == 0) return false;
    write(peer);
  }
  return true;
}

void LocalPublisher::warn_once(bool& has_warned, const std::string& text) {
  if (!std::exchange(has_warned, true)) log_.warning(text);
}

}  // namespace dts::ipc
