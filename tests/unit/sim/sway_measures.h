// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace dts::sim::measures {

/// The few posturography measures that say whether a COP looks like a person (posturography sections 1-4), for 100 Hz.
using Series = std::vector<double>;
inline constexpr double kRateHz = 100.0;

inline double mean(const Series& x) {
  double sum = 0.0;
  for (const double value : x) sum += value;
  return sum / static_cast<double>(x.size());
}

inline double population_sd(const Series& x) {
  const double centre = mean(x);
  double sum = 0.0;
  for (const double value : x) sum += (value - centre) * (value - centre);
  return std::sqrt(sum / static_cast<double>(x.size()));
}

inline double range(const Series& x) {
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  return *high - *low;
}

/// Butterworth of order 4, 10 Hz at 100 Hz, once forward, starting in the steady state of the first sample.
inline Series low_pass_once(const Series& x) {
  constexpr double b0 = 0.00482434335772;
  constexpr std::array<double, 5> b = {b0, 4 * b0, 6 * b0, 4 * b0, b0};
  constexpr std::array<double, 5> a = {1.0, -2.36951300718, 2.31398841442, -1.05466540588, 0.187379492368};
  std::array<double, 5> memory{};
  for (std::size_t i = 4; i >= 1; --i) memory[i - 1] = memory[i] + (b[i] - a[i]) * x.front();
  Series y;
  y.reserve(x.size());
  for (const double value : x) {
    const double out = b[0] * value + memory[0];
    for (std::size_t i = 1; i <= 4; ++i) memory[i - 1] = memory[i] + b[i] * value - a[i] * out;
    y.push_back(out);
  }
  return y;
}

/// Forward and backward (profile lp10, without padding).
inline Series low_pass(const Series& x) {
  Series y = low_pass_once(x);
  std::reverse(y.begin(), y.end());
  y = low_pass_once(y);
  std::reverse(y.begin(), y.end());
  return y;
}

/// MVELO of a path in the plane, mm/s.
inline double mean_velocity(const Series& x, const Series& y) {
  double path = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) path += std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
  return path * kRateHz / static_cast<double>(x.size());
}

struct Spectrum {
  double step_hz = 0.0;
  std::size_t first_bin = 0;
  Series density;  ///< mm2/Hz from `first_bin` on, over 0.15-5 Hz.

  /// Frequency below which `part` of the power lies.
  [[nodiscard]] double power_frequency(double part) const {
    double total = 0.0;
    for (const double value : density) total += value;
    double sum = 0.0;
    for (std::size_t i = 0; i < density.size(); ++i) {
      sum += density[i];
      if (sum >= part * total) return static_cast<double>(first_bin + i) * step_hz;
    }
    return 0.0;
  }
};

/// Eight sine tapers (MT8 of the sheet), one bin at a time by Goertzel's recurrence.
inline Spectrum spectrum(const Series& x) {
  const auto count = static_cast<double>(x.size());
  const double centre = mean(x);
  Spectrum result;
  result.step_hz = kRateHz / count;
  result.first_bin = static_cast<std::size_t>(std::ceil(0.15 / result.step_hz - 1e-9));
  result.density.assign(static_cast<std::size_t>(5.0 / result.step_hz + 1e-9) - result.first_bin + 1, 0.0);
  for (int taper = 1; taper <= 8; ++taper) {
    Series tapered(x.size());
    for (std::size_t n = 0; n < x.size(); ++n) {
      tapered[n] = (x[n] - centre) * std::sin(std::numbers::pi * taper * static_cast<double>(n + 1) / (count + 1.0));
    }
    for (std::size_t i = 0; i < result.density.size(); ++i) {
      const double factor = 2.0 * std::cos(2.0 * std::numbers::pi * static_cast<double>(result.first_bin + i) / count);
      double last = 0.0;
      double before = 0.0;
      for (const double value : tapered) {
        const double next = value + factor * last - before;
        before = last;
        last = next;
      }
      result.density[i] += (last * last + before * before - factor * last * before) * 4.0 / ((count + 1.0) * 8.0 * kRateHz);
    }
  }
  return result;
}

}  // namespace dts::sim::measures
