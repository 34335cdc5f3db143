// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "core/rate.h"
#include "pipeline/stage_state.h"
#include "pipeline/stages/contact.h"

namespace dts::pipeline {

/// How far and how fast the zero of a force plate has drifted: level and slope of the vertical force over windows in which nobody is on the
/// plate. Charge amplifiers drift linearly, so both together give the zero of later scans. A window starts 1 s after the person has left,
/// and only whole windows count. Thread: rig. Realtime-safe: yes.
///
/// Nobody is on the plate while the force is less than `kEmptyBelowN` above the drifted zero.
class ZeroDrift {
 public:
  static constexpr double kEmptyBelowN = 20.0;

  /// Returns to the initial state, with windows of `window_ms`, at least 3 scans.
  void prepare(core::Rate rate, double window_ms) noexcept;

  /// Adds the next scan. Returns true if it ends a window: `n_per_min` is new.
  bool add(double vertical_n) noexcept;
  /// Begins the window again: a scan has no value.
  void restart_window() noexcept;
  /// Uses a new zero, from which nothing has drifted yet. The slope remains: it is that of the amplifiers.
  void set_zero() noexcept;
  /// Continues after a gap, whose length does not count.
  void resume() noexcept;
  /// Forgets everything, also the slope.
  void reset() noexcept;

  /// Returns the slope; nothing before the end of the first window.
  [[nodiscard]] std::optional<double> n_per_min() const noexcept {
    return slope_n_per_scan_ ? std::optional(*slope_n_per_scan_ * scans_per_min_) : std::nullopt;
  }
  /// Returns whether the zero has probably drifted by more than 1 % of `vertical_n`, the force of a person. False for an empty plate.
  [[nodiscard]] bool is_doubtful(double vertical_n) const noexcept;

  static constexpr std::size_t kStateSize = Contact::kStateSize + 9;
  void save(StateWriter& writer) const noexcept;
  void restore(StateReader& reader) noexcept;

 private:
  /// Returns what an empty plate probably shows now, N.
  [[nodiscard]] double drifted_n() const noexcept { return level_n_ + slope_n_per_scan_.value_or(0.0) * static_cast<double>(since_level_); }

  Contact contact_{kEmptyBelowN};
  std::uint64_t window_scans_ = 3;
  std::uint64_t settle_scans_ = 1;
  double scans_per_min_ = 1.0;

  std::uint64_t settling_ = 0;  ///< Scans until a window may start.
  std::uint64_t scans_ = 0;     ///< In the window so far.
  double origin_n_ = 0.0;       ///< First value of the window; the sums are of offsets from it.
  double sum_n_ = 0.0;
  double weighted_sum_n_ = 0.0;    ///< Of offset x scan.
  double level_n_ = 0.0;           ///< Of the empty plate at the end of the last window, or 0 at a tare.
  std::uint64_t since_level_ = 0;  ///< Scans since then.
  std::optional<double> slope_n_per_scan_;
};

}  // namespace dts::pipeline
