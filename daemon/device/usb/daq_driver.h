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

/// Timeout of requests while a scan runs or ends. A device answers within one or two frames; a dead device must not block the caller.
inline constexpr int kControlTimeoutMs = 100;
/// Timeout of requests outside a scan: long enough for a busy hub, and a device that does not answer is found within 250 ms. (uldaq
/// waits 1000 ms, Linux_Drivers 2000 ms.)
inline constexpr int kSetupTimeoutMs = 200;

/// The scan that the driver must set up.
struct ScanRequest {
  core::Rate rate;                      ///< A result of `exact_rate`.
  std::int64_t latency_ns = 0;          ///< A scan should wait in the device at most this long.
  bool must_use_large_packets = false;  ///< The device has overrun with small packets.
  bool is_restart = false;              ///< An earlier scan delivered data: do not wait for the external trigger again.
};

/// The scan that the driver has set up.
struct ScanPlan {
  StreamShape shape;
  std::int64_t packet_period_ns = 0;  ///< Expected time between two packets.
  std::string sentence;               ///< Description for `device test`: "immediate, one scan per packet".
};

struct ScanHealth {
  bool is_running = false;
  bool is_overrun = false;
};

/// Result of unpacking a piece of the stream.
struct Unpacked {
  std::size_t bytes = 0;  ///< Bytes used. If fewer than passed: call again with the rest.
  std::size_t codes = 0;  ///< Codes written.
  /// None, or the fault after these codes. An incomplete scan is then void, and the next code is channel 0.
  core::GapReason fault = core::GapReason::None;
  bool goes_on = false;  ///< The device recovered by itself: report a gap of `discarded_scans`, no restart.
  std::uint64_t discarded_scans = 0;
};

/// Identity of a unit.
struct UnitIdentity {
  std::string serial;
  std::string firmware;
};

/// The interface of a driver for one family of DAQs. UsbDaq does the rest: transfers, time, integrity checks, unplugging.
/// Calls with a port may block. UsbDaq makes them one at a time, all but `health` and `set_sync_output` on the owner thread.
///
///     connect -> configure -> [read_once] -> make_ready -> (transfers in flight) begin -> unpack ... -> end -> configure ...
class DaqDriver {
 public:
  virtual ~DaqDriver() = default;

  /// Returns what is known without the unit: model, channels in scan order, rate limits.
  [[nodiscard]] virtual const DeviceDescription& describe() const noexcept = 0;
  /// Returns the products that this driver object accepts.
  [[nodiscard]] virtual std::span<const UsbModel> models() const noexcept = 0;
  /// Returns other products of the vendor, which may be plugged in by mistake.
  [[nodiscard]] virtual std::vector<UsbModel> relatives() const { return {}; }
  /// Returns the rate nearest to `wanted` that the device's clock can run. Fails with InvalidArgument outside its limits.
  [[nodiscard]] virtual core::Result<core::Rate> exact_rate(core::Rate wanted) const = 0;
  /// Converts a code to volts with the calibration that `connect` read. Thread: any. Realtime-safe: yes.
  [[nodiscard]] virtual double volts(std::size_t channel, std::uint16_t code) const noexcept = 0;
  /// Returns true if the code means "at or beyond the end of the range". Realtime-safe: yes.
  [[nodiscard]] virtual bool is_rail(std::size_t channel, std::uint16_t code) const noexcept = 0;

  /// Prepares a unit after opening: ends a scan that an earlier program left running, reads identity and calibration, appends its
  /// findings to `checks`. Fails with DataDamaged if the calibration is not plausible.
  [[nodiscard]] virtual core::Status connect(UsbPort& port, std::vector<DeviceCheck>& checks) = 0;
  /// Returns the identity of the connected unit as far as its USB descriptors do not contain it; empty fields: use the descriptors.
  [[nodiscard]] virtual UnitIdentity identity() const { return {}; }
  /// Sets up a scan while none is running. Resets the position in the stream.
  [[nodiscard]] virtual core::Result<ScanPlan> configure(UsbPort& port, const ScanRequest& request) = 0;
  /// Converts every channel once; returns V in scan order. Fails with Unsupported if the device has no such command.
  [[nodiscard]] virtual core::Result<std::vector<double>> read_once(UsbPort& port) = 0;
  /// Called last before transfers are submitted: removes data that single readings may have left in the device's buffer.
  [[nodiscard]] virtual core::Status make_ready(UsbPort&) { return {}; }
  /// Starts the scan when all transfers are in flight.
  [[nodiscard]] virtual core::Status begin(UsbPort& port) = 0;
  /// Ends the scan, if one is running. Called before the transfers are cancelled, also after a fault. After an error, it may still run.
  [[nodiscard]] virtual core::Status end(UsbPort& port) noexcept = 0;
  /// Requests the state of the scan: after its start, and when the device falls silent or a transfer fails.
  [[nodiscard]] virtual core::Result<ScanHealth> health(UsbPort& port) = 0;
  /// Returns true if the configured scan starts with an external signal: silence before the first scan is then not a fault.
  [[nodiscard]] virtual bool waits_for_trigger() const noexcept { return false; }
  /// Returns true if the first scan may be minutes after the start: earlier single readings cannot be compared with it then.
  [[nodiscard]] virtual bool may_start_late() const noexcept { return waits_for_trigger(); }
  /// Drives the digital line that signals a session to other instruments. May be called while a scan runs, and from another thread
  /// than the other calls.
  [[nodiscard]] virtual core::Status set_sync_output(UsbPort& port, bool is_high);

  /// Reads codes from the stream, in scan order, until `bytes` end, `codes` is full or a fault occurs. Realtime-safe: yes.
  [[nodiscard]] virtual Unpacked unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept = 0;
};

}  // namespace dts::device::usb
