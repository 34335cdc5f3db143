// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/loss_watch.h"
#include "core/rate.h"
#include "core/units.h"

namespace dts::core {

/// Host time of scans from the moments at which they arrived. A device's clock is steady but a little off; arrivals are late
/// by anything from a fraction of a millisecond to whatever the machine was busy with, and never early. So the truth runs
/// along the lower edge of the arrivals:
///
///     late by |  .    .         .      .        .       arrivals
///             |    .     .  .      .       .  .    .
///             |____________________________________     the straight line under all of them that is nearest to them
///                                              index
///
/// The line is the edge of the lower convex hull above the middle of the window (Moon, Skelly & Towsley, INFOCOM 1999). One
/// point per second, the least late one, is kept for `kWindowSeconds`; the line is drawn anew once per second. Until
/// `kDriftKnownSeconds` of them have come the slope is what an earlier segment found, or 0. All times are of `Clock::raw_ns`: a
/// wall clock that is set or slewed changes nothing; `monotonic_of_raw_ns` turns estimates into host time. Thread: one.
/// Realtime-safe: yes.
class HostTime {
 public:
  static constexpr std::size_t kWindowSeconds = 300;
  static constexpr double kDriftKnownSeconds = 10.0;
  static constexpr double kLargestDriftPpm = 10'000.0;  ///< Beyond this it is another rate, see `rate_error`.
  static constexpr double kCrystalPpm = 200.0;          ///< No crystal is further off; lateness that grows faster comes of lost scans.

  HostTime() = default;
  /// `frame_ns`: the shortest time from a scan to its arrival is uncertain by this (USB: one frame).
  HostTime(Rate rate, std::int64_t frame_ns) noexcept : rate_(rate), frame_ns_(frame_ns) {}

  /// A new segment: indices start at 0 again; what is known of the clock's drift stays. `not_before_ns`: scan 0 is not taken earlier
  /// (the start request was sent then); without it the first seconds are uncertain by `kUnknownLatenessNs`.
  void restart(std::optional<std::int64_t> not_before_ns = std::nullopt) noexcept;
  /// All scans up to and with `newest` had arrived at `arrived_ns`. Indices and times must not go back.
  void add(ScanIndex newest, std::int64_t arrived_ns) noexcept;

  /// Something has arrived in this segment.
  [[nodiscard]] bool has_estimate() const noexcept { return has_bin_; }
  /// Estimated host time of a scan; a later scan of a segment never gets an earlier time. 0 without an estimate.
  [[nodiscard]] std::int64_t at(ScanIndex index) noexcept;
  /// How far the last `at` may be off, ns: frame, scatter of the arrivals, what the drift could have done before it is known, and
  /// by how much the estimate was held back so that time does not go back.
  [[nodiscard]] std::int64_t uncertainty_ns() const noexcept;
  /// How much faster than nominal the device's clock runs, ppm; 0 until it is known.
  [[nodiscard]] double drift_ppm() const noexcept { return is_drift_known_ ? -slope_ * 1e6 : 0.0; }
  /// How much slower than nominal scans arrive, as a fraction, beyond what 20 ms of bad luck at either end could feign; 0 in the
  /// first two seconds. A value beyond +-0.01 says that the device does not run at the rate it was asked for.
  [[nodiscard]] double rate_error() const noexcept { return rate_error_; }
  /// The scans of this segment are enough to judge their rate, and whether some are missing.
  [[nodiscard]] bool is_judged() const noexcept { return is_rate_known_ && loss_watch_.has_compared(); }
  /// By how much the least lateness has risen, ns, beyond what the clock explains (`kCrystalPpm` until its drift is known, 50 ppm
  /// about it from then on): scans went missing on the way. Told within 3 s, from the first second of a segment on.
  [[nodiscard]] std::int64_t missing_ns() const noexcept { return loss_watch_.rise_ns(); }
  /// A rise above this is a loss: 3.5 ms, half a scan at low rates, or more than chance can do on a host that is very busy.
  [[nodiscard]] std::int64_t least_loss_ns() const noexcept;
  [[nodiscard]] bool has_loss() const noexcept { return missing_ns() > least_loss_ns(); }

 private:
  static constexpr std::int64_t kUnknownLatenessNs = 100'000'000;
  void close_bin() noexcept;
  void draw_line() noexcept;
  [[nodiscard]] double edge_slope() noexcept;
  [[nodiscard]] double steepest() const noexcept;
  [[nodiscard]] double line_ns(double time_s) const noexcept { return height_ns_ + slope_ * 1e9 * time_s; }
  [[nodiscard]] double nominal_s(ScanIndex index) const noexcept { return static_cast<double>(rate_.time_ns(index)) * 1e-9; }

  Rate rate_;
  std::int64_t frame_ns_ = 0;
  std::int64_t origin_ns_ = 0;
  std::array<Arrival, kWindowSeconds> points_{};
  std::array<Arrival, kWindowSeconds> hull_{};
  std::size_t point_count_ = 0;
  bool has_bin_ = false;
  std::int64_t bin_end_ns_ = 0;
  Arrival bin_;             ///< The least late arrival of the second that runs.
  double height_ns_ = 0.0;  ///< The line: late_ns at time 0 ...
  double slope_ = 0.0;      ///< ... and how it grows: seconds per second.
  bool is_drift_known_ = false;
  bool is_rate_known_ = false;
  LossWatch loss_watch_;
  double rate_error_ = 0.0;
  std::int64_t scatter_ns_ = 0;
  std::int64_t held_back_ns_ = 0;
  std::optional<std::int64_t> not_before_ns_;
  ScanIndex last_index_;
  std::int64_t last_ns_ = 0;
};

}  // namespace dts::core
