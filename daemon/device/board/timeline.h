// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/host_time.h"
#include "core/rate.h"

namespace dts::device::board {

/// Host times of scans. The position of a scan is its time by the board's clock: the ticks that the board sends, or the number of the scan
/// if it sends none. A counted loss moves the position, so the estimate continues across it. Thread: the reader. Realtime-safe: yes.
class Timeline {
 public:
  /// Begins a scan. `ticks_per_second` 0: scans carry no time. Keeps the known drift of the clock if `is_same_clock`.
  /// `not_before_ns`: raw time of the start request; nothing: unknown.
  void start(core::Rate rate, std::uint32_t ticks_per_second, bool is_same_clock, std::optional<std::int64_t> not_before_ns) noexcept;
  /// Begins again after a loss that nobody counted: positions start at 0.
  void restart() noexcept;

  /// Adds `count` scans that arrived together; `number` is the number of the first, lost scans included, and `ticks` its time (any value
  /// without ticks). Returns false if ticks and numbers contradict each other: the board lost scans without counting them, or it lies.
  [[nodiscard]] bool add(std::uint64_t number, std::uint32_t ticks, std::size_t count, std::int64_t arrived_ns) noexcept;
  /// Returns the position of a scan of the last `add`.
  [[nodiscard]] std::uint64_t position(std::size_t scan) const noexcept { return first_position_ + ticks_in(scan); }
  /// Returns the host's raw time of a position.
  [[nodiscard]] std::int64_t raw_ns_at(std::uint64_t position) noexcept { return host_time_.at({position}); }
  /// Returns the number of scans that are missing between the newest scan and `count` scans that arrived now, estimated from time.
  [[nodiscard]] std::uint64_t estimate_missing(std::size_t count, std::int64_t arrived_ns) noexcept;

  /// Returns how much faster than nominal the board scans, ppm; 0 until it is known.
  [[nodiscard]] double drift_ppm() const noexcept { return host_time_.drift_ppm() + ticks_ppm_; }
  [[nodiscard]] const core::HostTime& host_time() const noexcept { return host_time_; }
  [[nodiscard]] bool has_scans() const noexcept { return has_scans_; }
  /// Returns the time of one scan, ns.
  [[nodiscard]] std::int64_t period_ns() const noexcept { return rate_.time_ns({1}); }

 private:
  [[nodiscard]] std::uint64_t ticks_in(std::uint64_t scans) const noexcept;
  [[nodiscard]] bool agree(std::uint64_t ticks, std::uint64_t scans) const noexcept;

  core::Rate rate_;
  std::uint32_t ticks_per_second_ = 0;
  core::HostTime host_time_;
  bool has_scans_ = false;
  std::uint64_t first_position_ = 0;   ///< Of the first scan of the last `add`.
  std::uint64_t newest_position_ = 0;  ///< Of the newest scan.
  std::uint32_t last_ticks_ = 0;       ///< As sent, of the first scan of the last `add`.
  std::uint64_t first_number_ = 0;     ///< Of the scan at position 0.
  std::uint64_t last_number_ = 0;      ///< Of the first scan of the last `add`.
  std::uint64_t window_number_ = 0;    ///< Of the first scan of the window in which ticks and numbers are compared.
  std::uint64_t window_position_ = 0;
  double ticks_ppm_ = 0.0;  ///< How much faster than nominal the scans are, by the board's ticks.
};

}  // namespace dts::device::board
