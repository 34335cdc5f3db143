// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "core/rate.h"
#include "pipeline/stage_state.h"
#include "pipeline/stages/contact.h"

namespace dts::pipeline {

/// How fast the zero of a force plate drifts: the slope of the vertical force over windows in which nobody is on the plate. A window starts
/// 1 s after the person has left, and only whole windows count. Charge amplifiers drift linearly (sheet on force plates, section 2).
/// Thread: rig. Realtime-safe: yes.
class ZeroDrift {
 public:
  /// `empty_below_n`: with less vertical force nobody is on the plate.
  explicit ZeroDrift(double empty_below_n) noexcept : contact_(empty_below_n) {}

  /// Returns to the initial state, with windows of `window_ms`, at least 3 scans.
  void prepare(core::Rate rate, double window_ms) noexcept;

  /// Adds the next scan. Returns true if it ends a window: `n_per_min` is new.
  bool add(double vertical_n) noexcept;
  /// Begins the window again: the zero has changed, or a scan has no value.
  void restart_window() noexcept;
  /// Forgets everything, also the slope.
  void reset() noexcept;

  /// Returns the slope; nothing before the end of the first window.
  [[nodiscard]] std::optional<double> n_per_min() const noexcept {
    return slope_n_per_scan_ ? std::optional(*slope_n_per_scan_ * scans_per_min_) : std::nullopt;
  }
  /// Returns whether the force has probably drifted by more than 1 % of `vertical_n` since the plate was empty.
  [[nodiscard]] bool is_doubtful(double vertical_n) const noexcept;

  static constexpr std::size_t kStateSize = Contact::kStateSize + 8;
  void save(StateWriter& writer) const noexcept;
  void restore(StateReader& reader) noexcept;

 private:
  Contact contact_;
  std::uint64_t window_scans_ = 3;
  std::uint64_t settle_scans_ = 1;
  double scans_per_min_ = 1.0;

  std::uint64_t loaded_scans_ = 0;  ///< Since the plate was empty.
  std::uint64_t settling_ = 0;      ///< Scans until a window may start.
  std::uint64_t scans_ = 0;         ///< In the window so far.
  double origin_n_ = 0.0;           ///< First value of the window; the sums are of offsets from it.
  double sum_n_ = 0.0;
  double weighted_sum_n_ = 0.0;  ///< Of offset x scan.
  std::optional<double> slope_n_per_scan_;
};

}  // namespace dts::pipeline
