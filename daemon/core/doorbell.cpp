// SPDX-License-Identifier: Apache-2.0
#include "core/doorbell.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace dts::core {

Doorbell::Doorbell() : fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (fd_ < 0) throw std::system_error(errno, std::system_category(), "eventfd");
}

Doorbell::~Doorbell() { ::close(fd_); }

void Doorbell::ring() noexcept {
  const std::uint64_t one = 1;
  // write can fail only if the counter is at its maximum; then the bell is already rung.
  [[maybe_unused]] const auto written = ::write(fd_, &one, sizeof one);
}

bool Doorbell::wait(int timeout_ms) noexcept {
  pollfd waiter{.fd = fd_, .events = POLLIN, .revents = 0};
  ::poll(&waiter, 1, timeout_ms);
  return clear();
}

bool Doorbell::clear() noexcept {
  std::uint64_t rings = 0;
  return ::read(fd_, &rings, sizeof rings) == static_cast<ssize_t>(sizeof rings);
}

}  // namespace dts::core
