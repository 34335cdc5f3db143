// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/clock.h"
#include "core/host_time.h"
#include "device/device.h"
#include "device/usb/bulk_stream.h"
#include "device/usb/daq_driver.h"
#include "device/usb/daq_options.h"
#include "device/usb/scan_buffer.h"
#include "device/usb/start_checks.h"

namespace dts::device::usb {

/// Transfers of a device's streams that did not end with data, by `UsbStatus`.
using TransferErrors = std::array<std::atomic<std::uint64_t>, kUsbStatuses>;

/// What was started.
struct ScanSetup {
  core::Rate rate;
  std::size_t max_block_scans = 64;
  StreamShape shape;
  std::int64_t packet_period_ns = 0;
  std::optional<Marker> marker;
  std::vector<double> single_v;  ///< Readings before the scan; empty: the device has none.
};

/// The sample path of one scan, from its start to its stop: chunks of bytes in, blocks out, every doubt found.
///
///     chunk --unpack--> scans --held back until the start check--> marker, volts, quality, host time --> block
///       | status, drops, rate, lateness                                 |
///       +------------------> trouble: told when the scans before it are delivered <----+
///
/// Thread: the reader, but `findings`. Realtime-safe: yes while scans flow; a silent device is asked for its state.
class ScanReader {
 public:
  /// What the reader works with; all of it outlives the reader.
  struct Tools {
    DaqDriver& driver;
    UsbPort& port;
    BulkStream& stream;
    core::Clock& clock;
    core::HostTime& host_time;
    std::mutex& request_mutex;          ///< Orders control requests.
    std::atomic<bool>& is_interrupted;  ///< Makes `read` return early, once.
    TransferErrors& transfer_errors;
  };
  /// The scan runs from now on.
  ScanReader(const Tools& tools, ScanSetup setup);

  /// As Device::read while Streaming; Broken and Gone are repeated.
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept;
  /// The device's buffer or ours was full.
  [[nodiscard]] bool has_overrun() const noexcept { return trouble_.gap.reason == core::GapReason::Overrun; }
  /// Why the scan is Broken, if it is. Thread: the reader, or whoever has ended it.
  [[nodiscard]] std::optional<core::GapReason> break_reason() const noexcept;
  /// A scan has come since the start.
  [[nodiscard]] bool has_scanned() const noexcept { return has_scanned_; }
  /// What the checks of this scan say so far. Thread: any.
  [[nodiscard]] std::vector<DeviceCheck> findings() const;

 private:
  [[nodiscard]] bool has_trouble() const noexcept { return trouble_.outcome != ReadOutcome::Scans; }
  void set_trouble(ReadOutcome outcome, core::GapReason reason) noexcept { trouble_ = {outcome, {reason, 0, false}}; }
  void take_chunks(std::size_t wanted_scans) noexcept;
  [[nodiscard]] bool take_bytes(const Chunk& chunk) noexcept;
  void take_status(UsbStatus status) noexcept;
  void note_arrival(std::int64_t stamp_ns) noexcept;
  void check_start(bool is_final) noexcept;
  void deliver(core::Block& block, std::size_t wanted_scans) noexcept;
  void doubt_the_rest() noexcept;
  [[nodiscard]] std::int64_t host_time_ns() noexcept;
  [[nodiscard]] bool is_marker_right(std::size_t scan) noexcept;
  [[nodiscard]] ReadResult tell_trouble() noexcept;
  [[nodiscard]] ReadOutcome nothing() const noexcept;
  void ask_silent_device(std::int64_t now_ns) noexcept;
  [[nodiscard]] core::Result<ScanHealth> health() noexcept;
  [[nodiscard]] std::int64_t silence_limit_ns() const noexcept;

  Tools use_;
  ScanSetup setup_;
  std::size_t channels_;
  ScanBuffer scans_;
  std::size_t chunk_used_ = 0;   ///< Bytes of the oldest chunk that are unpacked.
  std::uint64_t arrived_ = 0;    ///< Whole scans of this segment, delivered or waiting ...
  std::uint64_t timed_ = 0;      ///< ... and those of which `host_time` was told.
  std::uint64_t delivered_ = 0;  ///< Of this segment.
  bool has_scanned_ = false;     ///< A scan has come since the start.
  std::int64_t heard_ns_ = 0;    ///< Start or newest chunk, by `now_ns`: the silence watch knows no other clock.
  std::int64_t asked_ns_ = 0;    ///< When the silent device last said that it runs.
  std::int64_t published_ns_;    ///< Host time of the newest block: slewing may not turn time back.
  ReadResult trouble_{ReadOutcome::Scans, {}};

  std::size_t held_scans_ = 0;  ///< To wait for before the first delivery; 0: the start check is over.
  std::vector<double> mean_v_;
  Agreement agreement_;
  std::atomic<bool> has_agreement_{false};
  std::atomic<bool> is_judged_{false};
  std::atomic<double> rate_error_{0.0};
  std::atomic<double> drift_ppm_{0.0};
  std::atomic<std::int64_t> missing_ns_{0};
  std::atomic<std::int64_t> least_loss_ns_;
  std::atomic<double> marker_v_;  ///< Newest; NaN before the first.
};

}  // namespace dts::device::usb
