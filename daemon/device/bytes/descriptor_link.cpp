// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/descriptor_link.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

namespace dts::device::bytes {
namespace {

constexpr std::int64_t kWriteLimitNs = 100 * core::kNanosecondsPerMillisecond;

timespec time_left(const core::Clock& clock, std::int64_t deadline_ns) noexcept {
  const std::int64_t now_ns = clock.now_ns();
  const std::int64_t left_ns = deadline_ns > now_ns ? deadline_ns - now_ns : 0;  // a deadline may be the smallest number: do not wait
  return {.tv_sec = left_ns / core::kNanosecondsPerSecond, .tv_nsec = left_ns % core::kNanosecondsPerSecond};
}

bool is_temporary(int system_errno) noexcept { return system_errno == EAGAIN || system_errno == EWOULDBLOCK || system_errno == EINTR; }

}  // namespace

void DescriptorLink::attach(Ends ends) noexcept {
  lost_.store(kNotLost, std::memory_order_release);  // pairs with lost()
  ends_.emplace(std::move(ends));
}

std::optional<int> DescriptorLink::lost() const noexcept {
  const int lost = lost_.load(std::memory_order_acquire);  // pairs with lose() and attach()
  return lost == kNotLost ? std::nullopt : std::optional(lost);
}

BytesRead DescriptorLink::lose(int system_errno) noexcept {
  int expected = kNotLost;  // the first reason is the cause; later ones follow from it
  lost_.compare_exchange_strong(expected, system_errno, std::memory_order_acq_rel, std::memory_order_acquire);  // pairs with lost()
  return {.end = ReadEnd::Lost, .count = 0, .raw_ns = clock_.raw_ns()};
}

BytesRead DescriptorLink::read(std::span<std::uint8_t> buffer, std::int64_t deadline_ns) noexcept {
  if (!ends_ || buffer.empty()) return {.end = ReadEnd::Lost, .count = 0, .raw_ns = clock_.raw_ns()};
  while (true) {
    // poll ignores negative descriptors.
    std::array<pollfd, 3> waiters{{{.fd = ends_->in.get(), .events = POLLIN, .revents = 0},
                                   {.fd = bell_.fd(), .events = POLLIN, .revents = 0},
                                   {.fd = ends_->end.get(), .events = POLLIN, .revents = 0}}};
    const timespec left = time_left(clock_, deadline_ns);
    const int ready = ::ppoll(waiters.data(), waiters.size(), &left, nullptr);
    const std::int64_t raw_ns = clock_.raw_ns();
    if (ready < 0 && !is_temporary(errno)) return lose(errno);
    if (ready < 0) continue;
    if (ready == 0) return {.end = ReadEnd::Timeout, .count = 0, .raw_ns = raw_ns};
    if (waiters[1].revents != 0) {
      bell_.clear();
      return {.end = ReadEnd::Interrupted, .count = 0, .raw_ns = raw_ns};
    }
    if (waiters[0].revents != 0) {  // also POLLHUP and POLLERR: the last bytes may wait before them
      const ssize_t count = ::read(ends_->in.get(), buffer.data(), buffer.size());
      if (count > 0) return {.end = ReadEnd::Bytes, .count = static_cast<std::size_t>(count), .raw_ns = raw_ns};
      if (count == 0) return lose(0);
      if (!is_temporary(errno)) return lose(errno);
      if ((waiters[0].revents & POLLIN) == 0) return lose(0);  // hung up without a byte: waiting would spin
      continue;
    }
    if (waiters[2].revents != 0) return lose(0);
  }
}

core::Status DescriptorLink::write(std::span<const std::uint8_t> bytes) {
  if (!ends_) return core::fail(core::ErrorCode::DeviceGone, "cannot write to " + name_ + ": it is not open");
  // The kernel may take bytes for a while after the other end has closed its side.
  if (lost()) return core::fail(core::ErrorCode::DeviceGone, "cannot write to " + name_ + ": it is lost");
  const int out = ends_->out.get() >= 0 ? ends_->out.get() : ends_->in.get();
  const std::int64_t deadline_ns = clock_.now_ns() + kWriteLimitNs;
  while (!bytes.empty()) {
    const ssize_t count =
        ends_->out_is_socket ? ::send(out, bytes.data(), bytes.size(), MSG_NOSIGNAL) : ::write(out, bytes.data(), bytes.size());
    if (count >= 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
      continue;
    }
    if (!is_temporary(errno)) {
      const int error = errno;
      static_cast<void>(lose(error));
      return core::fail(core::ErrorCode::DeviceGone, "cannot write to " + name_ + ": " + std::strerror(error));
    }
    const timespec left = time_left(clock_, deadline_ns);
    pollfd waiter{.fd = out, .events = POLLOUT, .revents = 0};
    if (::ppoll(&waiter, 1, &left, nullptr) == 0) {
      return core::fail(core::ErrorCode::Timeout, name_ + " does not take bytes: " + std::to_string(bytes.size()) + " were not written");
    }
  }
  return {};
}

}  // namespace dts::device::bytes
