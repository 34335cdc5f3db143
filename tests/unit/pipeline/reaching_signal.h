// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "unit/pipeline/standing_signal.h"

namespace dts::pipeline {

/// One synthetic reach: the load falls for a moment, rises while the trunk goes forward, stays, and all of it back.
struct MadeReach {
  double start_s = 2.0;
  double dip_mm = 0.4;
  double rise_mm = 1.5;
  double forward_s = 0.9;  ///< From the dip to the highest point.
  double hold_s = 0.2;

  static constexpr double kDipS = 0.35;

  [[nodiscard]] double highest_s() const { return start_s + kDipS + forward_s; }
  [[nodiscard]] double end_s() const { return highest_s() + hold_s + forward_s; }
  /// What it adds to the transient.
  [[nodiscard]] double at(double time_s) const {
    const double dip = std::clamp((time_s - start_s) / kDipS, 0.0, 1.0);
    const double rise = smooth((time_s - start_s - 0.5 * kDipS) / (forward_s + 0.5 * kDipS));
    const double back = smooth((time_s - highest_s() - hold_s) / forward_s);
    return -dip_mm * std::pow(std::sin(M_PI * dip), 2) + rise_mm * (rise - back);
  }
  static double smooth(double part) {
    const double s = std::clamp(part, 0.0, 1.0);
    return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);  // of least jerk
  }
};

/// Somebody on the chair, as the transient sees it.
struct SeatedPerson {
  double rest_mm = 3.7;
  double noise_mm = 0.012;
  std::vector<MadeReach> reaches{};
  double drift_mm_per_s = 0.0;
  double sits_down_s = -1.0;
  double stands_up_s = 1e9;
  double rest_ratio = -0.2;

  [[nodiscard]] double moved_mm(double time_s) const {
    double sum_mm = 0.0;
    for (const MadeReach& reach : reaches) sum_mm += reach.at(time_s);
    return sum_mm;
  }
  [[nodiscard]] bool is_seated(double time_s) const { return time_s >= sits_down_s && time_s < stands_up_s; }
  [[nodiscard]] double mm(double time_s) const { return is_seated(time_s) ? rest_mm + drift_mm_per_s * time_s + moved_mm(time_s) : 0.0; }
  /// Forward bending moves the weight to the front; the weight itself drops out.
  [[nodiscard]] double ratio(double time_s) const {
    return rest_mm > 0.0 ? rest_ratio + 0.26 * std::max(0.0, moved_mm(time_s)) / rest_mm : 0.0;
  }
};

/// The stream "transient" of a person.
inline Signal transient_of(const SeatedPerson& person, double duration_s, double hz = 100.0, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  const double noise_mm = person.noise_mm * std::sqrt(hz / 100.0);
  std::normal_distribution<double> noise(0.0, 1.0);
  const auto scans = static_cast<std::size_t>(duration_s * hz);
  std::vector<std::vector<double>> columns(3, std::vector<double>(scans));
  for (std::size_t i = 0; i < scans; ++i) {
    const double time_s = static_cast<double>(i) / hz;
    columns[0][i] = person.mm(time_s) + noise_mm * noise(random);
    columns[1][i] = person.ratio(time_s) + 0.003 * noise(random);
    columns[2][i] = 0.003 * noise(random);
  }
  Signal signal = make_signal(hz, "mm", columns);
  signal.format.channels = {{.name = "transient_mm", .unit = "mm"}, {.name = "ratio", .unit = "1"}, {.name = "twist", .unit = "1"}};
  return signal;
}

/// The stream "deflection" of the same: rear left, rear right, front left, front right.
inline Signal deflections_of(const SeatedPerson& person, double duration_s, double hz = 100.0, std::uint64_t seed = 1) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  const auto scans = static_cast<std::size_t>(duration_s * hz);
  std::vector<std::vector<double>> columns(4, std::vector<double>(scans));
  for (std::size_t i = 0; i < scans; ++i) {
    const double time_s = static_cast<double>(i) / hz;
    for (std::size_t c = 0; c < 4; ++c) {
      const double row = c < 2 ? -0.5 : 0.5;
      columns[c][i] = person.mm(time_s) * (1.0 + row * person.ratio(time_s)) + 2.0 * person.noise_mm * noise(random);
    }
  }
  return make_signal(hz, "mm", columns);
}

/// Input of stages that take a transient: reaches one after the other, after an empty seat; with faults a lost second, substituted and lost
/// values and somebody who stands up.
inline Signal reaching_transient(std::size_t scans, std::uint64_t seed, Faults faults) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  SeatedPerson person;
  const double duration_s = static_cast<double>(scans) / 100.0;
  for (double start_s = 0.8; start_s < duration_s; start_s += 3.5) {
    person.reaches.push_back({.start_s = start_s + 0.2 * uniform(random), .rise_mm = 0.1 + 2.0 * uniform(random), .forward_s = 0.6});
  }
  if (faults == Faults::Some && duration_s > 9.0) person.stands_up_s = duration_s - 1.0;
  Signal signal = transient_of(person, duration_s, 100.0, seed);
  for (std::size_t i = 0; faults == Faults::Some && i < signal.scans(); ++i) {
    const bool is_lost = uniform(random) < 0.01 || (i >= 600 && i < 700);
    const bool is_substituted = uniform(random) < 0.05;
    for (std::size_t c = 0; c < 3; ++c) {
      if (is_substituted) signal.bits[c][i] |= core::quality::kSubstituted;
      if (!is_lost) continue;
      signal.values[c][i] = std::numeric_limits<double>::quiet_NaN();
      signal.bits[c][i] |= core::quality::kRotation;
    }
  }
  return signal;
}

}  // namespace dts::pipeline
