// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <umockdev.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "usb/emulator/running_device.h"

namespace dts::emulator {

struct UnrefObject {
  void operator()(void* object) const noexcept { g_object_unref(object); }
};
template <class T>
using GObjectPtr = std::unique_ptr<T, UnrefObject>;

/// /dev/bus/usb/001/NNN of one plugged device: answers the ioctls that libusb
/// sends to usbfs.
///
///     libusb --SUBMITURB--> RunningDevice --finish--> finished_ --REAPURB-->
///     libusb
///                                             | FIFO: poll wakes, otherwise
///                                             sleeps
///
/// The file is a FIFO with room for one byte: full, nothing is finished and
/// libusb's poll(POLLOUT) sleeps. (umockdev's default, a regular file, is
/// always ready and costs half a core.) A node lives as long as the testbed:
/// clients may keep it open for as long as they like after the device has gone.
/// Thread: ioctls in umockdev's thread, the rest in the host's.
class UsbfsNode {
 public:
  /// `path` is the file inside the testbed; it is made here.
  UsbfsNode(std::string path, EmulatedDevice& device, Pace pace, const core::Clock& clock, std::function<void()> leave);
  ~UsbfsNode();
  UsbfsNode(const UsbfsNode&) = delete;
  UsbfsNode& operator=(const UsbfsNode&) = delete;

  [[nodiscard]] UMockdevIoctlBase* handler() const noexcept { return handler_.get(); }
  [[nodiscard]] std::shared_ptr<RunningDevice> running() const;
  /// Every transfer ends, every later call says ENODEV.
  void pull();
  /// Another program, which does not exist, holds interface 0.
  void occupy(bool is_occupied);
  [[nodiscard]] std::size_t urbs_in_flight() const;

 private:
  struct Urb {
    GObjectPtr<UMockdevIoctlData> data;
    UMockdevIoctlData* buffer = nullptr;  ///< A child of `data`.
    UMockdevIoctlClient* client = nullptr;
    FinishedTransfer result;
  };

  static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, gpointer self);
  [[nodiscard]] int answer(UMockdevIoctlClient* client);  ///< 0 or errno.
  [[nodiscard]] int claim(UMockdevIoctlClient* client);
  [[nodiscard]] int release(const UMockdevIoctlClient* client);
  [[nodiscard]] int clear_halt(UMockdevIoctlData* argument);
  [[nodiscard]] int submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  [[nodiscard]] int reap(const UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  [[nodiscard]] int discard(const UMockdevIoctlData* argument);
  static void start(std::uint64_t id, int type, std::uint8_t endpoint, std::span<const std::uint8_t> bytes, RunningDevice& running);
  void finish(FinishedTransfer transfer);
  void update_readiness();

  std::string path_;
  int fifo_ = -1;
  GObjectPtr<UMockdevIoctlBase> handler_;
  mutable std::mutex mutex_;
  bool is_gone_ = false;
  bool is_occupied_ = false;
  bool is_fifo_full_ = false;
  std::uint64_t next_id_ = 1;
  GObjectPtr<UMockdevIoctlClient> holder_;  ///< Who claimed interface 0.
  std::map<std::uint64_t, Urb> flying_;
  std::deque<Urb> finished_;
  std::shared_ptr<RunningDevice> running_;  ///< Empty when the device is gone.
};

}  // namespace dts::emulator
