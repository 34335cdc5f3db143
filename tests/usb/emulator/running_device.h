// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "device/usb/usb_status.h"
#include "usb/emulator/emulated_device.h"
#include "usb/emulator/urb_queue.h"

namespace dts::emulator {

/// How an emulated device's time runs.
enum class Pace : std::uint8_t {
  RealTime,  ///< With a clock, usually the machine's.
  LockStep,  ///< As fast as transfers are offered: a slow machine changes
             ///< nothing but the duration.
};

struct FinishedTransfer {
  std::uint64_t id = 0;
  device::usb::UsbStatus status = device::usb::UsbStatus::Completed;
  std::vector<std::uint8_t> bytes;  ///< Received from the device.
  std::size_t length = 0;           ///< Moved, in either direction.
};

/// An emulated device with a thread that runs it: what a host controller does
/// for hosts whose transfers come from outside. Transfers are offered with a
/// number and come back through `finish`, in any thread, with the device
/// locked.
class RunningDevice {
 public:
  using Finish = std::function<void(FinishedTransfer)>;

  /// Powers the device up. `leave` is called, locked, when the device asks to
  /// leave the bus.
  /// `clock`: of Pace::RealTime; it outlives this object.
  RunningDevice(EmulatedDevice& device, Pace pace, const core::Clock& clock, Finish finish, std::function<void()> leave);
  ~RunningDevice();
  RunningDevice(const RunningDevice&) = delete;
  RunningDevice& operator=(const RunningDevice&) = delete;

  /// Standard requests are answered from the descriptors.
  void control(std::uint64_t id, const Setup& setup, std::span<const std::uint8_t> out_data);
  void bulk_out(std::uint64_t id, std::uint8_t endpoint, std::span<const std::uint8_t> bytes);
  void bulk_in(std::uint64_t id, std::uint8_t endpoint, std::size_t capacity);
  /// The transfer finishes as Cancelled; false: it is not here any more.
  bool cancel(std::uint64_t id);
  void clear_halt(std::uint8_t endpoint);
  /// Hands over what is due by now, at once rather than when the device's own thread gets its turn.
  void catch_up();
  /// All transfers that wait end so.
  void end_all(device::usb::UsbStatus status);
  void power_up();

  /// Runs `action` while the device stands still: to set faults, to look
  /// inside.
  template <class Action>
  auto locked(Action action) {
    const std::lock_guard lock(mutex_);
    return action();
  }

 private:
  void run();
  void clear_halt_locked(std::uint8_t endpoint);
  [[nodiscard]] std::int64_t advance();
  [[nodiscard]] std::int64_t now_ns() const noexcept;
  [[nodiscard]] UrbQueue& queue(std::uint8_t endpoint);

  EmulatedDevice& device_;
  Pace pace_;
  const core::Clock& clock_;
  Finish finish_;
  std::function<void()> leave_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_ending_ = false;
  bool has_changed_ = false;
  std::int64_t lock_step_ns_ = 0;
  std::map<std::uint8_t, UrbQueue> queues_;
  std::set<std::uint64_t> unanswered_;  ///< Control transfers that the device ignores.
  std::thread thread_;
};

}  // namespace dts::emulator
