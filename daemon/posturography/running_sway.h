// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "core/sway.h"

namespace dts::posturography {

/// Exact sums over the centre of pressure of a growing window: Welford's means and co-moments, path, extremes (posturography sheet section
/// 3, "exact running"). Samples must be filtered and at the rate of analysis. Realtime-safe: yes.
class RunningSwaySums {
 public:
  static constexpr std::size_t kStateSize = 16;  ///< Largest number of values in a state; unused ones are 0.

  explicit RunningSwaySums(double rate_hz = 0.0) noexcept : rate_hz_(rate_hz) {}
  void reset() noexcept;
  void add(double ml_mm, double ap_mm) noexcept;
  /// Interrupts the path: the distance to the next sample does not count.
  void interrupt() noexcept { is_interrupted_ = samples_ > 0.0; }
  /// Adds the samples of `later`, which follow immediately (Chan, Golub, LeVeque 1979 for means and co-moments). The first of them is at
  /// `first_ml_mm`, `first_ap_mm`.
  void append(const RunningSwaySums& later, double first_ml_mm, double first_ap_mm) noexcept;
  [[nodiscard]] bool empty() const noexcept { return samples_ == 0.0; }
  [[nodiscard]] core::RunningSway values() const noexcept;

  [[nodiscard]] std::array<double, kStateSize> state() const noexcept;
  /// Returns false if the numbers are impossible; the sums are then reset.
  [[nodiscard]] bool set_state(std::span<const double, kStateSize> state) noexcept;

  friend bool operator==(const RunningSwaySums&, const RunningSwaySums&) = default;

 private:
  [[nodiscard]] bool is_sane() const noexcept;

  double rate_hz_;
  double samples_ = 0.0;
  double mean_ml_ = 0.0;
  double mean_ap_ = 0.0;
  double square_ml_ = 0.0;  ///< Sums of squared deviations from the mean.
  double square_ap_ = 0.0;
  double product_ = 0.0;
  double path_ = 0.0;
  double path_ml_ = 0.0;
  double path_ap_ = 0.0;
  double last_ml_ = 0.0;
  double last_ap_ = 0.0;
  double least_ml_ = 0.0;
  double most_ml_ = 0.0;
  double least_ap_ = 0.0;
  double most_ap_ = 0.0;
  bool is_interrupted_ = false;
};

}  // namespace dts::posturography
