// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/clock.h"
#include "device/usb/usb_bus.h"
#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

class FakePort;
struct Plug;

/// A USB bus inside the test, with a virtual clock: time passes only when somebody waits, and everything happens in the waiting
/// thread, in an order that is the same in every run. Hours of streaming take seconds. Thread: one.
///
/// Devices live by `raw_ns`: nobody slews their crystals. Whoever waits on the bus lets all devices go on. Advancing the clock itself is a
/// host that stood still meanwhile (suspended, or an event thread that did not run): devices find their buffers full.
class FakeBus final : public device::usb::UsbBus {
 public:
  explicit FakeBus(core::VirtualClock& clock) : clock_(clock) {}
  ~FakeBus() override;

  /// `device` outlives the bus or is unplugged before.
  void plug(EmulatedDevice& device);
  /// Transfers in flight end with NoDevice; open ports stay, every call on them says NoDevice.
  void unplug(EmulatedDevice& device);
  /// Time passes, transfers finish, listeners hear of them; nobody reads.
  void run_until(std::int64_t time_ns);

  /// How late a completion is noticed by the host, ns, asked for every completion: scheduling noise.
  std::function<std::int64_t()> lateness_ns;
  /// Asked for every transfer that ends, with their number so far (from 0) and how it ended: what the host is told instead.
  std::function<device::usb::UsbStatus(std::uint64_t, device::usb::UsbStatus)> completion_status;
  /// Called before each control or bulk OUT request reaches its device, with the number of such requests so far (from 0): unplug
  /// here to lose the device in the middle of a sequence.
  std::function<void(std::uint64_t)> on_request;
  /// Asked for each call of a port with its words, as "out 11 0 0 0000002a 2000 ms": what the caller is told instead of the device's
  /// answer.
  std::function<std::optional<device::usb::UsbResult>(const std::string&)> on_call;
  /// What each request takes.
  std::int64_t request_ns = core::kNanosecondsPerMillisecond;
  /// A device that asked to leave the bus is back after this.
  std::int64_t absence_ns = 500 * core::kNanosecondsPerMillisecond;
  /// Opening fails as if another program had the device.
  bool is_busy = false;
  /// Opening fails as if the udev rule were missing.
  bool is_forbidden = false;
  /// From now on submitting fails with NoDevice without notice of departure: either order happens with real hardware.
  bool refuses_submit = false;
  /// So many more are accepted, then `refuses_submit` becomes true.
  std::uint64_t submits_until_refusal = std::numeric_limits<std::uint64_t>::max();
  /// Cancelled transfers never come back: what a broken host controller does.
  bool swallows_cancel = false;
  /// Cancelled transfers come back after this: a machine that is too busy.
  std::int64_t cancel_ns = 0;
  [[nodiscard]] int transfers_in_flight() const;  ///< 0 when nothing was leaked; counts those that were freed in flight, too.
  [[nodiscard]] int open_ports() const;
  [[nodiscard]] std::uint64_t requests() const noexcept { return requests_; }  ///< Control and bulk OUT so far.

  [[nodiscard]] core::Result<std::vector<device::usb::UsbUnit>> units(std::span<const device::usb::UsbModel> models) override;
  [[nodiscard]] core::Result<std::unique_ptr<device::usb::UsbPort>> open(const device::usb::UsbUnit& unit) override;
  [[nodiscard]] std::uint64_t arrivals() const noexcept override;

 private:
  friend class FakePort;
  struct Absent {
    EmulatedDevice* device = nullptr;
    std::int64_t back_at_ns = 0;
  };
  [[nodiscard]] std::int64_t now_ns() const noexcept { return clock_.raw_ns(); }
  /// What `now_ns` here will say at a `time_ns` of the clock.
  [[nodiscard]] std::int64_t raw_of(std::int64_t time_ns) const noexcept { return time_ns - (clock_.now_ns() - clock_.raw_ns()); }
  [[nodiscard]] std::optional<device::usb::UsbResult> told(const std::string& call) const { return on_call ? on_call(call) : std::nullopt; }
  /// A request is made, which takes `time_ns`.
  void spend(std::int64_t time_ns);
  [[nodiscard]] bool accepts_submit() noexcept;
  /// Everything that happens at this moment.
  void settle();
  void settle_plugs();
  /// To the next event or `deadline_ns`, whichever is first.
  void step(std::int64_t deadline_ns);

  core::VirtualClock& clock_;
  std::uint64_t arrivals_ = 0;
  std::uint64_t requests_ = 0;
  std::uint64_t completions_ = 0;
  std::uint8_t next_address_ = 2;
  std::vector<std::shared_ptr<Plug>> plugs_;
  std::vector<Absent> absent_;
  std::vector<FakePort*> ports_;
  int abandoned_transfers_ = 0;
};

}  // namespace dts::emulator
