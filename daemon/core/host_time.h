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

/// Estimates the host time of scans from their arrival times. A device's clock is steady but slightly wrong. Arrivals are never
/// early; they are late by a fraction of a millisecond, or by much more on a busy machine. So the true time follows the lower
/// edge of the arrivals:
///
///     late by |  .    .         .      .        .       arrivals
///             |    .     .  .      .       .  .    .
///             |____________________________________     the straight line below all arrivals that is nearest to them
///                                              index
///
/// The line is the edge of the lower convex hull at the middle of the window (Moon, Skelly & Towsley, INFOCOM 1999). The least
/// late arrival of each second is kept for `kWindowSeconds`; the line is computed again once per second. In the first
/// `kDriftKnownSeconds` of a segment the slope is that of an earlier segment, or 0. All times are of `Clock::raw_ns`, so setting or
/// slewing the wall clock has no effect; `monotonic_of_raw_ns` converts estimates to host time.
///
/// If the host sleeps or is paused, its clock stands still while a device continues and counts. If more than 1 s of scans is lost, and the
/// next arrival is more than 1 s below the line, the estimate restarts there, and indices continue. Thread: one. Realtime-safe: yes.
class HostTime {
 public:
  static constexpr std::size_t kWindowSeconds = 300;
  static constexpr double kDriftKnownSeconds = 10.0;
  static constexpr double kLargestDriftPpm = 10'000.0;  ///< A larger drift is a wrong rate, see `rate_error`.
  static constexpr double kCrystalPpm = 200.0;          ///< Largest error of a crystal; lateness that grows faster comes from lost scans.

  /// What drives the device's clock. A ceramic resonator may be slow by 0.5 %: lateness that grows steadily is drift, up to
  /// `kLargestDriftPpm`, and only a step is a loss.
  enum class Oscillator : std::uint8_t { Crystal, Resonator };

  HostTime() = default;
  /// `frame_ns`: uncertainty of the shortest time from a scan to its arrival (USB: one frame).
  HostTime(Rate rate, std::int64_t frame_ns, Oscillator oscillator = Oscillator::Crystal) noexcept
      : rate_(rate), frame_ns_(frame_ns), oscillator_(oscillator) {}

  /// Starts a new segment: indices restart at 0, the known drift of the clock is kept. `not_before_ns`: earliest possible time of scan 0
  /// (the time of the start request); without it the first seconds are uncertain by `kUnknownLatenessNs`.
  void restart(std::optional<std::int64_t> not_before_ns = std::nullopt) noexcept;
  /// Adds an arrival: all scans up to and including `newest` had arrived at `arrived_ns`. Indices and times must not decrease.
  void add(ScanIndex newest, std::int64_t arrived_ns) noexcept;

  /// Returns true if scans have arrived in this segment.
  [[nodiscard]] bool has_estimate() const noexcept { return has_bin_; }
  /// Returns the estimated time of a scan; a later scan never has an earlier time, until the estimate restarts. 0 without an estimate.
  [[nodiscard]] std::int64_t at(ScanIndex index) noexcept;
  /// Returns the possible error of the last `at`, ns: frame, scatter of the arrivals, effect of a drift that is not known yet, and
  /// the delay that was added so that time does not run backwards.
  [[nodiscard]] std::int64_t uncertainty_ns() const noexcept;
  /// Returns how much faster than nominal the device's clock runs, ppm; 0 until it is known.
  [[nodiscard]] double drift_ppm() const noexcept { return is_drift_known_ ? -slope_ * 1e6 : 0.0; }
  /// Returns how much slower than nominal scans arrive, as a fraction, beyond the effect of 20 ms of arrival jitter; 0 in the
  /// first two seconds. Beyond +-0.01 the device does not run at the requested rate.
  [[nodiscard]] double rate_error() const noexcept { return rate_error_; }
  /// Returns true if this segment has enough scans to judge their rate and to find missing scans.
  [[nodiscard]] bool is_judged() const noexcept { return is_rate_known_ && loss_watch_.has_compared(); }
  /// Returns how much the least lateness has risen, ns, beyond the effect of the clock (up to `kCrystalPpm` until the drift is known, then
  /// drift +50 ppm; of a resonator also what grows steadily). A rise means that scans were lost on the way. Found within 3 s, from the
  /// first second of a segment on.
  [[nodiscard]] std::int64_t missing_ns() const noexcept { return loss_watch_.rise_ns(); }
  /// Returns the limit above which a rise is a loss: 3.5 ms, half a scan at low rates, or the possible scatter on a very busy host.
  [[nodiscard]] std::int64_t least_loss_ns() const noexcept;
  [[nodiscard]] bool has_loss() const noexcept { return missing_ns() > least_loss_ns(); }

 private:
  static constexpr std::int64_t kUnknownLatenessNs = 100'000'000;
  void close_bin() noexcept;
  void draw_line() noexcept;
  [[nodiscard]] std::int64_t estimate_ns(ScanIndex index) const noexcept;
  [[nodiscard]] double edge_slope() noexcept;
  [[nodiscard]] double largest_drift() const noexcept;
  [[nodiscard]] double steepest() const noexcept;
  [[nodiscard]] double steepest_steady() const noexcept;
  [[nodiscard]] double line_ns(double time_s) const noexcept { return height_ns_ + slope_ * 1e9 * time_s; }
  [[nodiscard]] double nominal_s(ScanIndex index) const noexcept { return static_cast<double>(rate_.time_ns(index)) * 1e-9; }

  Rate rate_;
  std::int64_t frame_ns_ = 0;
  Oscillator oscillator_ = Oscillator::Crystal;
  ScanIndex newest_;  ///< Of the last arrival.
  std::int64_t origin_ns_ = 0;
  std::array<Arrival, kWindowSeconds> points_{};
  std::array<Arrival, kWindowSeconds> hull_{};
  std::size_t point_count_ = 0;
  bool has_bin_ = false;
  std::int64_t bin_end_ns_ = 0;
  Arrival bin_;             ///< The least late arrival of the current second.
  double height_ns_ = 0.0;  ///< Of the line: late_ns at time 0.
  double slope_ = 0.0;      ///< Of the line: seconds per second.
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
