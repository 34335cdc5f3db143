// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "usb/emulator/emulated_device.h"
#include "usb/emulator/running_device.h"
#include "usb/umockdev/usbfs_node.h"

namespace dts::emulator {

/// A USB bus for unmodified libusb in this process and in children with
/// LD_PRELOAD=libumockdev-preload.so.0: sysfs, uevents and usbfs are
/// umockdev's, the devices are emulated. Needs no root and no kernel module.
///
///     libusb --open, ioctl, poll--> libumockdev-preload --> UsbfsNode -->
///     RunningDevice --> EmulatedDevice
///
/// Make it before anything that uses libusb, and destroy it after: clients look
/// for it at their start. One per process at a time.
class UmockdevHost {
 public:
  explicit UmockdevHost(Pace pace = Pace::RealTime) : UmockdevHost(pace, nullptr) {}
  /// In the real time of `clock`, which outlives the host; nullptr: the machine's.
  UmockdevHost(Pace pace, const core::Clock* clock);
  ~UmockdevHost();
  UmockdevHost(const UmockdevHost&) = delete;
  UmockdevHost& operator=(const UmockdevHost&) = delete;

  /// This program runs with the preload library, without which no uevent is
  /// sent.
  [[nodiscard]] static bool is_available();

  /// A device keeps its port (1-1, 1-2, ...) over unplugging, and has a new
  /// address each time. It outlives the host, or is unplugged before. Does
  /// nothing when it is plugged in already, or not.
  void plug(EmulatedDevice& device);
  void unplug(EmulatedDevice& device);
  /// The machine sleeps and wakes: transfers end, the device is seen to leave
  /// and to come back.
  void suspend(EmulatedDevice& device);
  /// Every plugged device hands over what is due by now.
  void catch_up() const;
  /// All transfers in flight end with this, as a bad cable does; the device
  /// stays.
  void end_transfers(EmulatedDevice& device, device::usb::UsbStatus status);
  void occupy(EmulatedDevice& device, bool is_occupied);
  [[nodiscard]] std::size_t urbs_in_flight(EmulatedDevice& device) const;
  /// Nobody but root may open the plugged device's node.
  void forbid(EmulatedDevice& device) const;
  /// Devices plugged in from now on have no serial number in sysfs.
  bool hides_serial = false;

  /// Runs `action` while the device stands still: to set faults, to look
  /// inside.
  void locked(EmulatedDevice& device, const std::function<void()>& action);

 private:
  struct Plugged {
    int address = 0;
    std::string syspath;
    std::unique_ptr<UsbfsNode> node;
  };

  void plug_locked(EmulatedDevice& device);
  void unplug_locked(EmulatedDevice& device);
  [[nodiscard]] std::string add_to_sysfs(const Descriptors& descriptors, int port, int address);
  [[nodiscard]] std::shared_ptr<RunningDevice> running(EmulatedDevice& device) const;
  void ask_to_leave(EmulatedDevice& device);
  void serve_leavers();

  Pace pace_;
  core::SystemClock system_clock_;
  const core::Clock& clock_;
  GObjectPtr<UMockdevTestbed> testbed_;
  std::string root_;
  mutable std::mutex mutex_;  ///< Who is plugged in; held while plugging.
  int next_address_ = 2;      ///< 1 is the root hub's.
  std::map<EmulatedDevice*, int> ports_;
  std::map<EmulatedDevice*, Plugged> plugged_;
  std::vector<std::unique_ptr<UsbfsNode>> pulled_;  ///< Clients may still have them open.

  std::mutex leavers_mutex_;
  std::condition_variable leavers_changed_;
  std::deque<EmulatedDevice*> leavers_;
  bool is_ending_ = false;
  std::thread leavers_thread_;  ///< Devices that asked for a reset are pulled
                                ///< and plugged in again from here.
};

}  // namespace dts::emulator
