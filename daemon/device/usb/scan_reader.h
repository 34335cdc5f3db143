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

/// Number of transfers of a device's streams that did not end as Completed, by `UsbStatus`.
using TransferErrors = std::array<std::atomic<std::uint64_t>, kUsbStatuses>;

/// Settings of a started scan.
struct ScanSetup {
  core::Rate rate;
  std::size_t max_block_scans = 64;
  StreamShape shape;
  std::int64_t packet_period_ns = 0;
  std::optional<Marker> marker;
  std::vector<double> single_v;  ///< Single readings before the scan; empty: none.
};

/// The sample path of one scan, from its start to its stop: reads chunks of bytes, checks them, and fills blocks.
///
///     chunk --unpack--> scans --held back until the start check--> marker, volts, quality, host time --> block
///       | status, drops, rate, lateness                                 |
///       +--------> trouble: reported after the scans before it <--------+
///
/// Thread: the reader, except `findings`. Realtime-safe: yes while scans flow; a silent device gets a request for its state.
class ScanReader {
 public:
  /// Objects that the reader uses; all of them must outlive the reader.
  struct Tools {
    DaqDriver& driver;
    UsbPort& port;
    BulkStream& stream;
    core::Clock& clock;
    core::HostTime& host_time;
    std::mutex& request_mutex;          ///< Serialises control requests.
    std::atomic<bool>& is_interrupted;  ///< Makes `read` return early, once.
    TransferErrors& transfer_errors;
  };
  /// Construct the reader right after the start of the scan.
  ScanReader(const Tools& tools, ScanSetup setup);

  /// Works as Device::read in state Streaming; repeats Broken and Gone.
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept;
  /// Works as Device::has_more in state Streaming: counts the scans that are unpacked.
  [[nodiscard]] bool has_more() const noexcept { return held_scans_ == 0 && !has_trouble() && scans_.scans() >= setup_.max_block_scans; }
  /// Returns true if the device's buffer or the buffer of chunks was full.
  [[nodiscard]] bool has_overrun() const noexcept { return trouble_.gap.reason == core::GapReason::Overrun; }
  /// Returns the reason if the scan is Broken. Thread: the reader, or the owner after the reader's last `read`.
  [[nodiscard]] std::optional<core::GapReason> break_reason() const noexcept;
  /// Returns true if a scan has arrived since the start.
  [[nodiscard]] bool has_scanned() const noexcept { return has_scanned_; }
  /// Returns the results of this scan's checks so far. Thread: any.
  [[nodiscard]] std::vector<DeviceCheck> findings() const;

 private:
  [[nodiscard]] bool has_trouble() const noexcept { return trouble_.outcome != ReadOutcome::Scans; }
  void set_trouble(ReadOutcome outcome, core::GapReason reason) noexcept { trouble_ = {outcome, {reason, 0, false}}; }
  void read_chunks(std::size_t wanted_scans) noexcept;
  [[nodiscard]] bool add_bytes(const Chunk& chunk) noexcept;
  void handle_status(UsbStatus status) noexcept;
  void note_arrival(std::int64_t stamp_ns) noexcept;
  void check_start(bool is_final) noexcept;
  void deliver(core::Block& block, std::size_t wanted_scans) noexcept;
  void doubt_the_rest() noexcept;
  [[nodiscard]] std::int64_t host_time_ns() noexcept;
  [[nodiscard]] bool is_marker_right(std::size_t scan) noexcept;
  [[nodiscard]] ReadResult report_trouble() noexcept;
  [[nodiscard]] ReadOutcome nothing() const noexcept;
  void ask_silent_device(std::int64_t now_ns) noexcept;
  [[nodiscard]] core::Result<ScanHealth> health() noexcept;
  [[nodiscard]] std::int64_t silence_limit_ns() const noexcept;

  Tools use_;
  ScanSetup setup_;
  std::size_t channels_;
  ScanBuffer scans_;
  std::size_t chunk_used_ = 0;       ///< Number of unpacked bytes of the oldest chunk.
  std::uint64_t arrived_ = 0;        ///< Whole scans of this segment, delivered or waiting.
  std::uint64_t timed_ = 0;          ///< Scans of this segment that were added to `host_time`.
  std::uint64_t delivered_ = 0;      ///< Delivered scans of this segment.
  bool has_scanned_ = false;         ///< A scan has arrived since the start.
  std::int64_t newest_data_ns_ = 0;  ///< Time of the start or of the newest chunk, by `now_ns`, as everything in the silence watch.
  std::int64_t asked_ns_ = 0;        ///< When the silent device last reported that it runs.
  std::int64_t published_ns_;        ///< Host time of the newest block; ensures that slewing never makes times decrease.
  ReadResult trouble_{ReadOutcome::Scans, {}};

  std::size_t held_scans_ = 0;  ///< Number of scans that the start check needs before the first delivery; 0: the start check is done.
  std::vector<double> mean_v_;
  Agreement agreement_;
  std::atomic<bool> has_agreement_{false};
  std::atomic<bool> is_judged_{false};
  std::atomic<double> rate_error_{0.0};
  std::atomic<double> drift_ppm_{0.0};
  std::atomic<std::int64_t> missing_ns_{0};
  std::atomic<std::int64_t> least_loss_ns_;
  std::atomic<double> marker_v_;  ///< Newest voltage of the marker channel; NaN before the first.
};

}  // namespace dts::device::usb
