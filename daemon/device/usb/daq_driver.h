// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/rate.h"
#include "core/result.h"
#include "device/device.h"
#include "device/usb/bulk_stream.h"
#include "device/usb/usb_bus.h"
#include "device/usb/usb_port.h"

namespace dts::device::usb {

/// Of requests while a scan runs or ends: they answer within a frame or two; a dead device must not hold us.
inline constexpr int kControlTimeoutMs = 100;
/// Of a request outside a scan: a busy hub may take its time, and a device that does not answer is known within 250 ms. (uldaq waits
/// 1000 ms, Linux_Drivers 2000.)
inline constexpr int kSetupTimeoutMs = 200;

/// What the driver is asked to run.
struct ScanRequest {
  core::Rate rate;                      ///< As `exact_rate` gave it.
  std::int64_t latency_ns = 0;          ///< A scan should not wait in the device for longer than this.
  bool must_use_large_packets = false;  ///< The last scan overran with small ones.
  bool is_restart = false;              ///< A scan has come before: the external trigger is not waited for again.
};

/// What the driver set up.
struct ScanPlan {
  StreamShape shape;
  std::int64_t packet_period_ns = 0;  ///< How often the device should have something to say.
  std::string sentence;               ///< "immediate, one scan per packet": for `device test`.
};

struct ScanHealth {
  bool is_running = false;
  bool is_overrun = false;
};

/// What a piece of the stream turned out to be.
struct Unpacked {
  std::size_t bytes = 0;  ///< Consumed. Fewer than given: call again with the rest.
  std::size_t codes = 0;  ///< Written.
  /// None, or what happened after these codes. The scan under way, if any, is void and the next code is channel 0 again.
  core::GapReason fault = core::GapReason::None;
  bool goes_on = false;  ///< The device recovered by itself: a gap of `discarded_scans`, no restart.
  std::uint64_t discarded_scans = 0;
};

/// Who a unit is.
struct UnitIdentity {
  std::string serial;
  std::string firmware;
};

/// What one family of DAQs must say; the rest of a device (transfers, time, integrity, the cable) is UsbDaq's.
/// Control calls may wait; they come from the device's owner thread, and never two at once.
///
///     connect -> configure -> [read_once] -> make_ready -> (transfers in flight) begin -> unpack ... -> end -> configure ...
class DaqDriver {
 public:
  virtual ~DaqDriver() = default;

  /// What is known without the device: model, channels in scan order, rate limits.
  [[nodiscard]] virtual const DeviceDescription& describe() const noexcept = 0;
  /// Products that this driver object accepts.
  [[nodiscard]] virtual std::span<const UsbModel> models() const noexcept = 0;
  /// Other products of the maker: what may be plugged in by mistake.
  [[nodiscard]] virtual std::vector<UsbModel> relatives() const { return {}; }
  /// The rate nearest to `wanted` that the device's clock can give. InvalidArgument: out of its limits.
  [[nodiscard]] virtual core::Result<core::Rate> exact_rate(core::Rate wanted) const = 0;
  /// One code as a voltage, by the calibration that `connect` read. Thread: any. Realtime-safe: yes.
  [[nodiscard]] virtual double volts(std::size_t channel, std::uint16_t code) const noexcept = 0;
  /// The code stands for "at or beyond the end of the range". Realtime-safe: yes.
  [[nodiscard]] virtual bool is_rail(std::size_t channel, std::uint16_t code) const noexcept = 0;

  /// After opening: ends a scan that an earlier program left behind, reads identity and calibration. DataDamaged: the
  /// calibration is not believable. Appends what it found to `checks`.
  [[nodiscard]] virtual core::Status connect(UsbPort& port, std::vector<DeviceCheck>& checks) = 0;
  /// Of the unit that `connect` saw, where its USB descriptors do not tell; empty fields: they do.
  [[nodiscard]] virtual UnitIdentity identity() const { return {}; }
  /// Sets up a scan, none is running. Forgets the position in the stream.
  [[nodiscard]] virtual core::Result<ScanPlan> configure(UsbPort& port, const ScanRequest& request) = 0;
  /// One conversion of every channel, V, in scan order; Unsupported when the device has no such command.
  [[nodiscard]] virtual core::Result<std::vector<double>> read_once(UsbPort& port) = 0;
  /// The last words before transfers are submitted: takes away what single readings may have left in the device's buffer.
  [[nodiscard]] virtual core::Status make_ready(UsbPort&) { return {}; }
  /// Starts the scan; all transfers are in flight.
  [[nodiscard]] virtual core::Status begin(UsbPort& port) = 0;
  /// Ends the scan, if one runs. Called before the transfers are cancelled, also after a fault. An error: it may still run.
  [[nodiscard]] virtual core::Status end(UsbPort& port) noexcept = 0;
  /// Asked when the device falls silent.
  [[nodiscard]] virtual core::Result<ScanHealth> health(UsbPort& port) = 0;
  /// The scan that was configured starts with an external signal: silence before the first scan is no fault.
  [[nodiscard]] virtual bool waits_for_trigger() const noexcept { return false; }
  /// Minutes may lie between the start and the first scan: single readings from before say nothing about it.
  [[nodiscard]] virtual bool may_start_late() const noexcept { return waits_for_trigger(); }
  /// Drives the digital line that tells other instruments of a session. May be called while a scan runs, from another thread
  /// than the other calls.
  [[nodiscard]] virtual core::Status set_sync_output(UsbPort& port, bool is_high);

  /// Reads codes from the stream, in scan order, until `bytes` end, `codes` is full or something happens. Realtime-safe: yes.
  [[nodiscard]] virtual Unpacked unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept = 0;
};

}  // namespace dts::device::usb
