// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "lab/compare/recording.h"

namespace dts::lab::compare {

/// A sway-like signal, mm: many incommensurable slow waves, so that no two stretches look alike.
inline double sway(double t_s, double seed) {
  double value = 0.0;
  for (int k = 1; k <= 12; ++k) {
    const double frequency_hz = 0.07 * std::pow(static_cast<double>(k), 1.37);
    value += 6.0 / k * std::sin(2.0 * std::numbers::pi * frequency_hz * t_s + seed * k * k);
  }
  return value;
}

struct Clock {
  double first_s = 0.0;    ///< Reading at the first scan.
  double offset_s = 0.0;   ///< To be added to its readings for true time...
  double drift_ppm = 0.0;  ///< ...and how much slow it is, about its 0.
  double rate_hz = 100.0;
  double length_s = 25.0;

  [[nodiscard]] double true_s(double reading_s) const { return reading_s + offset_s + 1e-6 * drift_ppm * reading_s; }
};

inline Recording recorded(const Clock& clock, double noise_mm = 0.0, double gain = 1.0, double shift_mm = 0.0) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, noise_mm > 0.0 ? noise_mm : 1.0);
  Recording recording;
  const auto count = static_cast<int>(clock.length_s * clock.rate_hz);
  for (int k = 0; k < count; ++k) {
    const double t_s = clock.first_s + k / clock.rate_hz;
    recording.t_s.push_back(t_s);
    recording.x_mm.push_back(gain * sway(clock.true_s(t_s), 0.3) + shift_mm + (noise_mm > 0.0 ? noise(random) : 0.0));
    recording.y_mm.push_back(gain * sway(clock.true_s(t_s), 0.8) - shift_mm + (noise_mm > 0.0 ? noise(random) : 0.0));
  }
  return recording;
}

/// High while true time is within 50 ms after one of `at_s`, which rise.
inline void add_triggers(Recording& recording, const Clock& clock, const std::vector<double>& at_s) {
  std::vector<double> level;
  for (const double t_s : recording.t_s) {
    const double now_s = clock.true_s(t_s);
    const auto next = std::ranges::upper_bound(at_s, now_s);
    const bool is_high = next != at_s.begin() && now_s < *(next - 1) + 0.05;
    level.push_back(is_high ? 4.9 : 0.1);
  }
  const RisingEdges edges = rising_edges(recording.t_s, level);
  recording.edges_s = edges.at_s;
  recording.edge_step_s = edges.step_s;
}

/// True offset at the alignment's reference.
inline double offset_at(const Clock& clock, double t_s) { return clock.true_s(t_s) - t_s; }

}  // namespace dts::lab::compare
