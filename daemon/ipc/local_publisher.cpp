// SPDX-License-Identifier: Apache-2.0
#include "ipc/local_publisher.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "dts/v1/stream.pb.h"
#include "dts/zmtp/zmtp.h"
#include "ipc/endpoint.h"

namespace dts::ipc {
namespace {

constexpr std::string_view kScheme = "ipc://";
constexpr int kBacklog = 64;
constexpr int kAcceptsPerTurn = 16;
constexpr std::size_t kBytesPerTurn = 1024;  ///< Read from one peer: some hundred subscriptions.
constexpr std::size_t kLongestFrame = 512;   ///< From a peer: READY with its properties, or a subscription.
constexpr std::size_t kRoomForEvents = 8;    ///< This part of a queue (an eighth) is not used for blocks.

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
  if (epoll < 0 || !control(epoll, EPOLL_CTL_ADD, listener, EPOLLIN) || !control(epoll, EPOLL_CTL_ADD, publisher->blocked_.fd(), EPOLLIN)) {
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
  const int count = ::epoll_wait(epoll_, events_.data(), static_cast<int>(events_.size()), timeout_ms);
  event_count_ = static_cast<std::size_t>(std::max(count, 0));
}

bool LocalPublisher::take_subscriptions() {
  bool has_new_subscription = false;
  bool has_new_peers = false;
  for (const epoll_event& event : std::span(events_).first(std::exchange(event_count_, 0))) {
    if (event.data.fd == listener_) {
      has_new_peers = true;
    } else if (event.data.fd == blocked_.fd()) {
      blocked_.clear();
      for (auto& [fd, peer] : peers_) resize_queue(peer);
    } else {
      handle(event, has_new_subscription);
    }
  }
  if (has_new_peers) accept_peers();  // last: a new connection may get the descriptor of one that has ended
  if (listens_again_ns_) listen_again();
  if (handshakes_ > 0) leave_late_handshakes();
  return has_new_subscription;
}

void LocalPublisher::handle(const epoll_event& event, bool& has_new_subscription) {
  const auto found = peers_.find(event.data.fd);
  if (found == peers_.end()) return;
  Peer& peer = found->second;
  if ((event.events & EPOLLOUT) != 0) {
    write(peer);
    resize_queue(peer);
  }
  const bool has_ended = (event.events & (EPOLLHUP | EPOLLERR)) != 0;
  if (!has_ended && (event.events & EPOLLIN) == 0) return;
  const Outcome outcome = has_ended ? Outcome::Leave : read(peer);
  if (outcome != Outcome::Leave && !peer.is_blocked && !peer.out.empty()) write(peer);  // answers to pings
  has_new_subscription |= outcome == Outcome::NewSubscription;
  if (outcome == Outcome::Leave) leave(event.data.fd);
}

void LocalPublisher::accept_peers() {
  for (int turn = 0; turn < kAcceptsPerTurn; ++turn) {
    const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (fd < 0) {
      if (errno == EMFILE || errno == ENFILE) pause_listening();
      return;
    }
    accept(fd);
  }
}

/// Without a free descriptor the listener stays readable; it would wake this thread all the time.
void LocalPublisher::pause_listening() {
  if (!control(epoll_, EPOLL_CTL_DEL, listener_, 0)) return;
  listens_again_ns_ = clock_.now_ns() + kAcceptPauseNs;
  warn_once(has_warned_of_descriptors_,
            "the data socket cannot accept a client: no file descriptor is free, and dtsd tries again every second; end clients that are "
            "not needed");
}

void LocalPublisher::listen_again() {
  if (clock_.now_ns() >= *listens_again_ns_ && control(epoll_, EPOLL_CTL_ADD, listener_, EPOLLIN)) listens_again_ns_.reset();
}

void LocalPublisher::accept(int fd) {
  const int pid = process_of(fd);
  if (!make_room_for(pid) || !control(epoll_, EPOLL_CTL_ADD, fd, EPOLLIN)) {
    ::close(fd);
    return;
  }
  Peer& peer = peers_[fd];
  peer.fd = fd;
  peer.pid = pid;
  peer.connected_ns = clock_.now_ns();
  ++handshakes_;
  std::string opening = zmtp::greeting();
  zmtp::append_ready(opening, "XPUB");
  peer.out.reserve(kSmallQueueBytes);
  static_cast<void>(peer.out.push(opening));
  write(peer);
}

/// Returns whether a process may have one more connection. If all are in use, ends another one for it.
bool LocalPublisher::make_room_for(int pid) {
  const auto of_process =
      static_cast<std::size_t>(std::ranges::count_if(peers_, [pid](const auto& entry) { return entry.second.pid == pid; }));
  if (of_process < kMostPeersOfAProcess && peers_.size() < kMostPeers) return true;
  warn_once(has_warned_of_peers_, "the data socket rejects or ends connections: it serves " + std::to_string(kMostPeers) + ", and " +
                                      std::to_string(kMostPeersOfAProcess) + " of one process; end clients that are not needed");
  if (of_process >= kMostPeersOfAProcess) return false;
  const std::optional<int> replaced = replaceable(of_process);
  if (replaced) leave(*replaced);
  return replaced.has_value();
}

/// Returns a connection that a newcomer may replace: one without a subscription, else the newest one of the process that has the most. That
/// process must have two more than the newcomer's, so that two processes do not replace each other's connections forever.
std::optional<int> LocalPublisher::replaceable(std::size_t of_newcomer) const {
  struct Share {
    std::size_t count = 0;
    const Peer* newest = nullptr;
  };
  std::map<int, Share> shares;
  const Share* largest = nullptr;
  const std::int64_t now_ns = clock_.now_ns();
  for (const auto& [fd, peer] : peers_) {
    if (peer.prefixes.empty() && now_ns - peer.connected_ns > kHandshakeNs) return fd;
    Share& share = shares[peer.pid];
    ++share.count;
    if (share.newest == nullptr || peer.connected_ns >= share.newest->connected_ns) share.newest = &peer;
    if (largest == nullptr || share.count > largest->count) largest = &share;
  }
  if (largest == nullptr || largest->count < of_newcomer + 2) return std::nullopt;
  return largest->newest->fd;
}

void LocalPublisher::leave(int fd) {
  const auto peer = peers_.find(fd);
  if (peer == peers_.end()) return;
  if (peer->second.state != State::Open) --handshakes_;
  if (peer->second.misses_event) {
    warn_once(has_warned_of_events_, "a client of the data socket (process " + std::to_string(peer->second.pid) +
                                         ") was disconnected: it read too slowly, and an event found no room in its queue");
  }
  for (auto& [topic, subscribers] : topics_) std::erase(subscribers, &peer->second);
  static_cast<void>(control(epoll_, EPOLL_CTL_DEL, fd, 0));  // closing is not enough while a forked process has the descriptor, too
  ::close(fd);
  peers_.erase(peer);
}

void LocalPublisher::leave_late_handshakes() {
  const std::int64_t now_ns = clock_.now_ns();
  std::vector<int> late;
  for (const auto& [fd, peer] : peers_) {
    if (peer.state != State::Open && now_ns - peer.connected_ns > kHandshakeNs) late.push_back(fd);
  }
  for (const int fd : late) leave(fd);
}

/// A peer that is gone is left at its next event (EPOLLHUP), so that nobody's iterator breaks here.
void LocalPublisher::write(Peer& peer) {
  while (!peer.out.empty()) {
    const std::string_view waiting = peer.out.waiting();
    const ssize_t sent = ::send(peer.fd, waiting.data(), waiting.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      peer.out.pop(static_cast<std::size_t>(sent));
    } else if (sent < 0 && errno == EAGAIN) {
      return watch_for_room(peer, true);
    } else if (sent == 0 || errno != EINTR) {
      peer.out.pop(peer.out.size());
      ::shutdown(peer.fd, SHUT_RDWR);  // a frame may be cut: the connection ends, and EPOLLHUP follows
    }
  }
  if (peer.misses_event) ::shutdown(peer.fd, SHUT_RDWR);  // the peer can still read what it was sent
  watch_for_room(peer, false);
}

/// Gives a blocked peer the large queue, and takes it back when all is written. Not in `write`, which must not allocate.
void LocalPublisher::resize_queue(Peer& peer) {
  if (!peer.is_blocked) {
    if (peer.out.empty() && peer.out.capacity() > kSmallQueueBytes) peer.out.reserve(kSmallQueueBytes);
    return;
  }
  if (peer.out.capacity() >= kQueueBytes) return;
  std::size_t large = 0;
  std::size_t of_process = 0;
  for (const auto& [fd, other] : peers_) {
    if (other.out.capacity() < kQueueBytes) continue;
    ++large;
    if (other.pid == peer.pid) ++of_process;
  }
  if (large < kMostLargeQueues && of_process < kMostLargeQueuesOfAProcess) peer.out.reserve(kQueueBytes);
}

void LocalPublisher::watch_for_room(Peer& peer, bool is_blocked) {
  if (peer.is_blocked == is_blocked) return;
  peer.is_blocked = is_blocked;
  static_cast<void>(control(epoll_, EPOLL_CTL_MOD, peer.fd, EPOLLIN | (is_blocked ? EPOLLOUT : 0U)));
  if (is_blocked) blocked_.ring();
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
  if (!peer.is_matched) match(peer);
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
  if (command->name == "PING") {
    std::string pong;
    zmtp::append_pong(pong, command->data);
    static_cast<void>(peer.out.push(pong));  // a peer that does not read gets no answers
  }
  return Outcome::Fine;
}

LocalPublisher::Outcome LocalPublisher::change_subscription(Peer& peer, bool is_new, std::string_view prefix) {
  peer.is_matched = false;
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

void LocalPublisher::match(Peer& peer) {
  peer.is_matched = true;
  for (auto& [topic, subscribers] : topics_) {
    std::erase(subscribers, &peer);
    if (matches(peer, topic)) subscribers.push_back(&peer);
  }
}

bool LocalPublisher::matches(const Peer& peer, std::string_view topic) {
  for (std::size_t size = 0; size <= topic.size(); ++size) {
    if (peer.prefixes.contains(topic.substr(0, size))) return true;
  }
  return false;
}

void LocalPublisher::expect(std::string_view topic) { static_cast<void>(subscribers_of(topic)); }

LocalPublisher::Subscribers& LocalPublisher::subscribers_of(std::string_view topic) {
  if (const auto known = topics_.find(topic); known != topics_.end()) return known->second;
  Subscribers& subscribers = topics_[std::string(topic)];
  for (auto& [fd, peer] : peers_) {
    if (matches(peer, topic)) subscribers.push_back(&peer);
  }
  return subscribers;
}

void LocalPublisher::send(std::string_view topic, const google::protobuf::MessageLite& message) {
  const Subscribers& subscribers = subscribers_of(topic);
  if (subscribers.empty() || !encode(topic, message)) return;  // encoded once, for all subscribers
  const bool is_event = dynamic_cast<const dts::v1::Event*>(&message) != nullptr;
  for (Peer* peer : subscribers) offer(*peer, is_event);
}

bool LocalPublisher::encode(std::string_view topic, const google::protobuf::MessageLite& message) {
  body_.clear();
  if (!message.AppendToString(&body_)) return false;
  frames_.clear();
  zmtp::append_frame(frames_, topic, true);
  zmtp::append_frame(frames_, body_);
  return true;
}

/// Queues `frames_` for a subscriber, or drops the message. Blocks leave room for events.
void LocalPublisher::offer(Peer& peer, bool is_event) {
  const auto has_queued = [&] { return !peer.misses_event && peer.out.push(frames_, is_event ? 0 : peer.out.capacity() / kRoomForEvents); };
  if (has_queued()) return;
  if (!peer.is_blocked) {
    write(peer);
    if (has_queued() || send_directly(peer)) return;
  }
  ++dropped_;
  peer.misses_event |= is_event;
}

/// Sends a message that is longer than the small queue, which only the publish thread does. Needs memory if the kernel takes only a part of
/// it. Returns false if nothing was sent.
bool LocalPublisher::send_directly(Peer& peer) {
  if (peer.is_blocked || peer.misses_event || !peer.out.empty()) return false;
  const ssize_t sent = ::send(peer.fd, frames_.data(), frames_.size(), MSG_NOSIGNAL);
  if (sent <= 0) {
    if (errno == EAGAIN) watch_for_room(peer, true);
    return false;
  }
  const std::string_view rest = std::string_view(frames_).substr(static_cast<std::size_t>(sent));
  if (rest.empty()) return true;
  if (peer.out.capacity() < rest.size()) peer.out.reserve(rest.size());
  static_cast<void>(peer.out.push(rest));
  write(peer);
  return true;
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
