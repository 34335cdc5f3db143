// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "core/rate.h"
#include "pipeline/stage_state.h"
#include "pipeline/stages/contact.h"

namespace dts::pipeline {

/// How far and how fast the zero of a force plate has drifted, from the vertical force over windows in which nobody is on the plate. Charge
/// amplifiers drift linearly, so the straight line from the tare to the last window gives the zero of later scans. A slope within a window
/// would be that of slow noise. A window starts 1 s after the person has left, and only whole windows count.
/// Thread: rig. Realtime-safe: yes.
///
/// Nobody is on the plate while the force is less than `kEmptyBelowN` above the drifted zero.
class ZeroDrift {
 public:
  static constexpr double kEmptyBelowN = 20.0;

  /// Returns to the initial state, with windows of `window_ms`, at least 3 scans.
  void prepare(core::Rate rate, double window_ms) noexcept;

  /// Adds the next scan. Returns true if it ends a window with which `n_per_min` is new.
  bool add(double vertical_n) noexcept;
  /// A scan without a value: the window begins again.
  void skip() noexcept;
  /// Uses a new zero, the mean of the last `tare_scans` scans. The slope remains until the next window: it is that of the amplifiers.
  void set_zero(std::uint64_t tare_scans) noexcept;
  /// Continues after a gap of unknown length: the next window begins a new line.
  void resume() noexcept;
  /// Forgets everything, also the slope.
  void reset() noexcept;

  /// Returns the slope; nothing before the end of the first window.
  [[nodiscard]] std::optional<double> n_per_min() const noexcept {
    return slope_n_per_scan_ ? std::optional(*slope_n_per_scan_ * scans_per_min_) : std::nullopt;
  }
  /// Returns whether the zero has probably drifted by more than 1 % of `vertical_n`. False below `kEmptyBelowN`, which nothing takes for a
  /// person.
  [[nodiscard]] bool is_doubtful(double vertical_n) const noexcept;

  static constexpr std::size_t kStateSize = Contact::kStateSize + 11;
  void save(StateWriter& writer) const noexcept;
  void restore(StateReader& reader) noexcept;

 private:
  /// Returns what an empty plate probably shows now, N.
  [[nodiscard]] double drifted_n() const noexcept { return level_n_ + slope_n_per_scan_.value_or(0.0) * since_level_; }
  void count_scan() noexcept;
  void restart_window() noexcept;

  Contact contact_{kEmptyBelowN};
  std::uint64_t window_scans_ = 3;
  std::uint64_t settle_scans_ = 1;
  double scans_per_min_ = 1.0;

  std::uint64_t settling_ = 0;  ///< Scans until a window may start.
  std::uint64_t scans_ = 0;     ///< In the window so far.
  double origin_n_ = 0.0;       ///< First value of the window; the sum is of offsets from it.
  double sum_n_ = 0.0;
  bool has_begin_ = false;  ///< The line has a first point: the tare, or a window.
  double begin_n_ = 0.0;
  double since_begin_ = 0.0;  ///< Scans since that point.
  double level_n_ = 0.0;      ///< Of the empty plate in the middle of the last window, or 0 at a tare.
  double since_level_ = 0.0;  ///< Scans since then.
  std::optional<double> slope_n_per_scan_;
};

}  // namespace dts::pipeline
