// SPDX-License-Identifier: Apache-2.0
#include "ipc_source.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace dts::client {
namespace {

using std::chrono::milliseconds;

constexpr std::string_view kScheme = "ipc://";
constexpr std::size_t kFirstBuffer = std::size_t{64} << 10U;
constexpr std::size_t kFrameHeaders = 18;  // of two frames
constexpr std::size_t kLongestCommand = 1024;
constexpr std::size_t kMostPending = 64U << 10U;  // subscriptions; a daemon that does not read gets no more answers to its pings

int poll_one(int socket, short events, milliseconds timeout) {
  pollfd waited{.fd = socket, .events = events, .revents = 0};
  return ::poll(&waited, 1, static_cast<int>(timeout.count()));
}

Waited waited(int polled) noexcept {
  if (polled > 0) return Waited::Ready;
  return polled == 0 ? Waited::TimedOut : Waited::Interrupted;
}

}  // namespace

Result<std::unique_ptr<IpcSource>> IpcSource::open(const SourceOptions& options) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::string path = options.endpoint.substr(kScheme.size());
  if (path.empty() || path.size() >= sizeof address.sun_path || path.find('\0') != std::string::npos) {
    return fail(ErrorCode::InvalidArgument, "cannot use the data address '" + options.endpoint + "': its path must have 1 to " +
                                                std::to_string(sizeof address.sun_path - 1) + " bytes");
  }
  const bool is_abstract = path[0] == '@';  // as in libzmq: a name that is no file
  if (is_abstract) path[0] = '\0';
  std::memcpy(address.sun_path, path.data(), path.size());
  const auto bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size() + (is_abstract ? 0 : 1));
  std::unique_ptr<IpcSource> source(new IpcSource(address, bytes, options.largest_message));
  source->connect_if_due(options.handshake_limit);
  return source;
}

void IpcSource::subscribe(const std::string& prefix) {
  if (subscriptions_[prefix]++ > 0 || state_ != State::Open) return;
  zmtp::append_frame(pending_, '\1' + prefix);
  send_pending();
}

void IpcSource::unsubscribe(const std::string& prefix) {
  const auto found = subscriptions_.find(prefix);
  if (found == subscriptions_.end() || --found->second > 0) return;
  subscriptions_.erase(found);
  if (state_ != State::Open) return;
  zmtp::append_frame(pending_, '\0' + prefix);
  send_pending();
}

void IpcSource::connect_if_due(milliseconds handshake_limit) {
  if (state_ != State::Away || Clock::now() < retry_at_) return;
  socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  // Connecting to a local socket does not wait for the peer; if its queue is full, SO_SNDTIMEO ends the call, and the next attempt follows.
  const timeval limit{.tv_sec = 0, .tv_usec = 1000};
  const bool is_connected = socket_ >= 0 && ::setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit) == 0 &&
                            ::connect(socket_, reinterpret_cast<const sockaddr*>(&address_), address_bytes_) == 0;
  if (!is_connected) return go_away(false);
  state_ = State::Greeting;
  receive_timeout_ = milliseconds(-1);
  pending_ = zmtp::greeting();
  zmtp::append_ready(pending_, "SUB");
  send_pending();
  wait_until_open(handshake_limit);
}

/// Waits for the answer of a daemon that runs, so that the subscriptions are on their way. A daemon gives up handshakes that take long, and
/// the caller may not call for long.
void IpcSource::wait_until_open(milliseconds limit) {
  const auto deadline = Clock::now() + limit;
  while (state_ == State::Greeting || state_ == State::Handshake) {
    if (shake_hands()) return;
    const auto left = std::chrono::ceil<milliseconds>(deadline - Clock::now());
    if (left <= milliseconds::zero()) return;
    std::ignore = wait(left);
  }
}

void IpcSource::close() noexcept {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

void IpcSource::go_away(bool is_fault) {
  close();
  const bool was_open = state_ == State::Open;
  if (was_open) ++interruptions_;
  state_ = State::Away;
  begin_ = end_ = taken_ = 0;
  is_drained_ = is_skipping_ = false;
  has_fault_ = has_fault_ || is_fault;
  pending_.clear();
  const auto now = Clock::now();
  // The daemon ends the connection of a reader that was slow: mode Latest needs the new one within its `catch_up`.
  if (was_open && !is_fault && now - opened_at_ >= kSlowestReconnect) {
    retry_at_ = now;
    return;
  }
  retry_at_ = now + retry_after_;
  retry_after_ = std::min(2 * retry_after_, kSlowestReconnect);
}

/// Makes room for at least one byte behind the bytes that were not processed yet.
void IpcSource::make_room() {
  if (begin_ == end_) begin_ = end_ = 0;
  if (end_ < buffer_.size()) return;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    return;
  }
  buffer_.resize(std::clamp(2 * buffer_.size(), kFirstBuffer, 2 * largest_message_ + kFrameHeaders));
}

/// Returns whether bytes arrived.
bool IpcSource::accept(ssize_t received) {
  if (received > 0) {
    end_ += static_cast<std::size_t>(received);
    is_drained_ = end_ < buffer_.size();
    return true;
  }
  is_drained_ = true;
  if (received == 0 || (errno != EAGAIN && errno != EINTR)) go_away(false);
  return false;
}

bool IpcSource::read(int flags) {
  make_room();
  return accept(::recv(socket_, buffer_.data() + end_, buffer_.size() - end_, flags));
}

/// Returns whether the connection is open now.
bool IpcSource::shake_hands() {
  if (state_ == State::Greeting) {
    if (!zmtp::fault_of_greeting(unread()).empty()) {
      go_away(true);
      return false;
    }
    if (unread().size() < zmtp::kGreetingBytes) return false;
    begin_ += zmtp::kGreetingBytes;
    state_ = State::Handshake;
  }
  const auto result = zmtp::next_frame(unread(), kLongestCommand);
  const auto* frame = std::get_if<std::optional<zmtp::Frame>>(&result);
  if (frame != nullptr && !*frame) return false;
  const auto command = frame != nullptr && (*frame)->is_command ? zmtp::command_of((*frame)->body) : std::nullopt;
  const auto peer = command && command->name == "READY" ? zmtp::property_of(command->data, "Socket-Type") : std::nullopt;
  if (!peer || (*peer != "XPUB" && *peer != "PUB")) {
    go_away(true);
    return false;
  }
  begin_ += (*frame)->size;
  state_ = State::Open;
  retry_after_ = kFirstReconnect;
  opened_at_ = Clock::now();
  for (const auto& [prefix, count] : subscriptions_) zmtp::append_frame(pending_, '\1' + prefix);
  send_pending();
  return state_ == State::Open;
}

/// Obeys the commands of an open connection; unknown ones are ignored, as ZMTP demands.
void IpcSource::obey(std::span<const std::byte> body) {
  const auto command = zmtp::command_of(body);
  if (!command || command->name == "ERROR") return go_away(true);
  if (command->name != "PING" || pending_.size() > kMostPending) return;
  zmtp::append_pong(pending_, command->data);
  send_pending();
}

/// Returns the next complete message of the buffer.
std::optional<RawMessage> IpcSource::parse() {
  if (state_ == State::Greeting || state_ == State::Handshake) {
    if (!shake_hands()) return std::nullopt;
  }
  while (state_ == State::Open) {
    const auto first = zmtp::next_frame(unread(), largest_message_);
    const auto* frame = std::get_if<std::optional<zmtp::Frame>>(&first);
    if (frame == nullptr) {
      go_away(true);
      return std::nullopt;
    }
    if (!*frame) return std::nullopt;
    const zmtp::Frame& topic = **frame;
    if (topic.is_command) {
      begin_ += topic.size;
      obey(topic.body);
      continue;
    }
    if (is_skipping_ || !topic.has_more) {
      begin_ += topic.size;
      const bool is_end = !topic.has_more;
      is_skipping_ = !is_end;
      if (is_end) return RawMessage{};
      continue;
    }
    const auto second = zmtp::next_frame(unread().subspan(topic.size), largest_message_);
    const auto* body = std::get_if<std::optional<zmtp::Frame>>(&second);
    if (body == nullptr || (*body && (*body)->is_command)) {
      go_away(true);
      return std::nullopt;
    }
    if (!*body) return std::nullopt;
    if ((*body)->has_more) {
      begin_ += topic.size + (*body)->size;
      is_skipping_ = true;
      continue;
    }
    taken_ = topic.size + (*body)->size;
    return RawMessage{
        .topic = {reinterpret_cast<const char*>(topic.body.data()), topic.body.size()}, .body = (*body)->body, .is_well_formed = true};
  }
  return std::nullopt;
}

std::optional<RawMessage> IpcSource::take() {
  begin_ += std::exchange(taken_, 0);
  if (!has_fault_) connect_if_due(kReconnectHandshake);
  while (true) {
    if (std::exchange(has_fault_, false)) return RawMessage{};
    if (state_ != State::Away) {
      if (auto message = parse()) return message;
      if (has_fault_) continue;
    }
    if (state_ == State::Away || std::exchange(is_drained_, false) || !read(MSG_DONTWAIT)) return std::nullopt;
  }
}

void IpcSource::send_pending() {
  while (!pending_.empty()) {
    const ssize_t sent = ::send(socket_, pending_.data(), pending_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent > 0) {
      pending_.erase(0, static_cast<std::size_t>(sent));
    } else if (sent < 0 && errno == EAGAIN) {
      return;  // `wait` continues
    } else if (sent == 0 || errno != EINTR) {
      return pending_.clear();  // the daemon has ended: `read` finds that behind its last messages
    }
  }
}

Waited IpcSource::wait_away(milliseconds timeout) {
  const auto left = std::chrono::ceil<milliseconds>(retry_at_ - Clock::now());
  const Waited slept = waited(poll_one(-1, 0, std::clamp(left, milliseconds::zero(), timeout)));
  if (slept == Waited::Interrupted) return slept;
  connect_if_due(kReconnectHandshake);
  return left < timeout ? Waited::Ready : Waited::TimedOut;
}

/// For the rare case that the kernel did not accept everything that must be sent.
Waited IpcSource::wait_for_both(milliseconds timeout) const { return waited(poll_one(socket_, POLLIN | POLLOUT, timeout)); }

Waited IpcSource::wait(milliseconds timeout) {
  begin_ += std::exchange(taken_, 0);
  if (state_ == State::Away) return wait_away(timeout);
  if (!pending_.empty()) {
    const Waited both = wait_for_both(timeout);
    is_drained_ = false;
    if (both == Waited::Ready) send_pending();
    return both;
  }
  if (timeout <= milliseconds::zero()) {
    is_drained_ = false;
    return read(MSG_DONTWAIT) ? Waited::Ready : Waited::TimedOut;
  }
  if (timeout != receive_timeout_) {
    const timeval limit{.tv_sec = timeout.count() / 1000, .tv_usec = timeout.count() % 1000 * 1000};
    if (::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit) != 0) {
      go_away(false);
      return Waited::Ready;
    }
    receive_timeout_ = timeout;
  }
  make_room();
  const ssize_t received = ::recv(socket_, buffer_.data() + end_, buffer_.size() - end_, 0);
  if (received < 0 && errno == EINTR) return Waited::Interrupted;
  const bool is_timeout = received < 0 && errno == EAGAIN;
  std::ignore = accept(received);
  return is_timeout ? Waited::TimedOut : Waited::Ready;
}

}  // namespace dts::client
