// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/running_device.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>
#include <vector>

#include "usb/emulator/standard_requests.h"

namespace dts::emulator {
namespace {

using device::usb::UsbStatus;

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kLongestNs = 100'000'000;  // a device whose plan changes is noticed at least so often
constexpr std::int64_t kShortestNs = 250'000;     // packets nearer than this are taken together

}  // namespace

RunningDevice::RunningDevice(EmulatedDevice& device, Pace pace, const core::Clock& clock, Finish finish, std::function<void()> leave)
    : device_(device), pace_(pace), clock_(clock), finish_(std::move(finish)), leave_(std::move(leave)) {
  device_.power_up(now_ns());
  thread_ = std::thread([this] { run(); });
}

RunningDevice::~RunningDevice() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::int64_t RunningDevice::now_ns() const noexcept { return pace_ == Pace::RealTime ? clock_.now_ns() : lock_step_ns_; }

UrbQueue& RunningDevice::queue(std::uint8_t endpoint) {
  return queues_.try_emplace(endpoint, endpoint, packet_bytes_of(device_.descriptors(), endpoint)).first->second;
}

void RunningDevice::control(std::uint64_t id, const Setup& setup, std::span<const std::uint8_t> out_data) {
  const std::lock_guard lock(mutex_);
  if (const auto endpoint = halt_cleared_by(setup)) clear_halt_locked(*endpoint);
  const auto standard = standard_reply(device_.descriptors(), setup);
  ControlReply reply = standard ? *standard : device_.control(setup, out_data, now_ns());
  has_changed_ = true;  // it may have started a scan
  changed_.notify_all();
  if (device_.wants_to_leave()) leave_();
  if (reply.kind == ReplyKind::Silence) {
    unanswered_.insert(id);
    return;
  }
  if (reply.data.size() > setup.length) reply.data.resize(setup.length);
  const bool is_in = (setup.request_type & 0x80) != 0;
  const bool is_done = reply.kind == ReplyKind::Done;
  if (!is_in || !is_done) reply.data.clear();
  const std::size_t length = !is_done ? 0 : is_in ? reply.data.size() : out_data.size();
  finish_({id, is_done ? UsbStatus::Completed : UsbStatus::Stall, std::move(reply.data), length});
}

void RunningDevice::bulk_out(std::uint64_t id, std::uint8_t endpoint, std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  device_.bulk_out(endpoint, bytes, now_ns());
  has_changed_ = true;
  changed_.notify_all();
  finish_({id, UsbStatus::Completed, {}, bytes.size()});
}

void RunningDevice::bulk_in(std::uint64_t id, std::uint8_t endpoint, std::size_t capacity) {
  const std::lock_guard lock(mutex_);
  queue(endpoint).submit(id, capacity);
  // What waits in the device is handed over at once, as by a host controller: a short timeout then says that there is nothing.
  if (pace_ == Pace::RealTime) static_cast<void>(advance());
  has_changed_ = true;
  changed_.notify_all();
}

void RunningDevice::catch_up() {
  const std::lock_guard lock(mutex_);
  static_cast<void>(advance());
}

bool RunningDevice::cancel(std::uint64_t id) {
  const std::lock_guard lock(mutex_);
  if (unanswered_.erase(id) > 0) {
    finish_({id, UsbStatus::Cancelled, {}, 0});
    return true;
  }
  for (auto& [endpoint, urbs] : queues_) {
    if (auto finished = urbs.cancel(id)) {
      const std::size_t length = finished->bytes.size();
      finish_({id, UsbStatus::Cancelled, std::move(finished->bytes), length});
      return true;
    }
  }
  return false;
}

void RunningDevice::clear_halt_locked(std::uint8_t endpoint) {
  device_.clear_halt(endpoint);
  if ((endpoint & 0x80) != 0) queue(endpoint).clear_halt();
  has_changed_ = true;
  changed_.notify_all();
}

void RunningDevice::clear_halt(std::uint8_t endpoint) {
  const std::lock_guard lock(mutex_);
  clear_halt_locked(endpoint);
}

void RunningDevice::end_all(UsbStatus status) {
  const std::lock_guard lock(mutex_);
  for (const std::uint64_t id : std::exchange(unanswered_, {})) finish_({id, status, {}, 0});
  for (auto& [endpoint, urbs] : queues_) {
    for (FinishedUrb& urb : urbs.end_all(status)) finish_({urb.id, status, {}, 0});
  }
}

void RunningDevice::power_up() {
  const std::lock_guard lock(mutex_);
  device_.power_up(now_ns());
}

std::int64_t RunningDevice::advance() {
  bool is_wanted = false;
  for (auto& [endpoint, urbs] : queues_) {
    for (FinishedUrb& urb : urbs.advance(device_, now_ns())) {
      const std::size_t length = urb.bytes.size();
      finish_({urb.id, urb.status, std::move(urb.bytes), length});
    }
    is_wanted = is_wanted || urbs.is_waiting();
  }
  return is_wanted ? device_.next_packet_ns(now_ns()) : kNever;
}

void RunningDevice::run() {
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    has_changed_ = false;
    const std::int64_t next_ns = advance();
    if (pace_ == Pace::LockStep && next_ns != kNever && next_ns > lock_step_ns_) {
      lock_step_ns_ = next_ns;
      lock.unlock();  // whoever offers transfers must get a turn
      std::this_thread::yield();
      lock.lock();
      continue;
    }
    const std::int64_t left_ns = next_ns == kNever ? kLongestNs : std::clamp(next_ns - now_ns(), kShortestNs, kLongestNs);
    changed_.wait_for(lock, std::chrono::nanoseconds(left_ns), [this] { return is_ending_ || has_changed_; });
  }
}

}  // namespace dts::emulator
