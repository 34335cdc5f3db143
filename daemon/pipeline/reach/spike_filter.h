// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "pipeline/stage_state.h"

namespace dts::pipeline {

/// Removes single outliers from a signal: if a value differs from the median of the last seven (itself included) by more than six times
/// their median absolute deviation, and by more than `kLeast`, returns the median in its place (Hampel 1974, The influence curve and its
/// role in robust estimation; Pearson 2002, Outliers in process modeling and identification). Uses past values only, so there is no delay;
/// a step passes after three values. Slopes pass too, because they increase the deviation as much as the distance from the median.
class SpikeFilter {
 public:
  static constexpr std::size_t kWindow = 7;
  static constexpr double kLeast = 0.15;  ///< mm; 100 times the noise of the median for sensors with 3 mV noise.
  static constexpr std::size_t kStateSize = 2 + kWindow;

  /// `value` must be finite. Realtime-safe: yes.
  double filter(double value) noexcept {
    values_[next_] = value;
    next_ = (next_ + 1) % kWindow;
    count_ = std::min(count_ + 1, kWindow);
    if (count_ < 3) return value;
    if (is_calm()) return value;
    std::array<double, kWindow> sorted = values_;
    const double median = median_of(sorted, count_);
    for (std::size_t i = 0; i < count_; ++i) sorted[i] = std::abs(values_[i] - median);
    const double limit = std::max(6.0 * median_of(sorted, count_), kLeast);
    return std::abs(value - median) > limit ? median : value;
  }
  void reset() noexcept {
    values_ = {};
    next_ = 0;
    count_ = 0;
  }

  void save(StateWriter& writer) const noexcept {
    writer.put_count(count_);
    writer.put_count(next_);
    for (const double value : values_) writer.put(value);
  }
  void restore(StateReader& reader) noexcept {
    count_ = static_cast<std::size_t>(reader.count(kWindow));
    next_ = static_cast<std::size_t>(reader.count(kWindow - 1));
    for (double& value : values_) value = reader.number(-1e6, 1e6);
  }

 private:
  /// Returns whether all values are so close together that none can be an outlier. Nearly always true, and cheaper than a median.
  [[nodiscard]] bool is_calm() const noexcept {
    double lowest = values_[0];
    double highest = values_[0];
    for (std::size_t i = 1; i < count_; ++i) {
      lowest = std::min(lowest, values_[i]);
      highest = std::max(highest, values_[i]);
    }
    return highest - lowest <= kLeast;
  }
  static double median_of(std::array<double, kWindow>& values, std::size_t count) noexcept {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(count));
    return *middle;
  }

  std::array<double, kWindow> values_{};  ///< The first `count_` values are valid.
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

}  // namespace dts::pipeline
