// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "unit/pipeline/standing_signal.h"

namespace dts::pipeline {

/// Makes scans [first, first + scans) missing, as where nobody stands.
inline void step_off(Signal& signal, std::size_t first, std::size_t scans) {
  for (std::size_t i = first; i < std::min(first + scans, signal.scans()); ++i) {
    for (std::size_t c = 0; c < 2; ++c) {
      signal.values[c][i] = std::numeric_limits<double>::quiet_NaN();
      signal.bits[c][i] |= core::quality::kNoContact;
    }
    signal.values[2][i] = 1.0;
  }
}

/// The centre of pressure of somebody who stands, in mm and N: slow sway, faster sway and noise.
inline Signal swaying_cop(double hz, std::size_t scans, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<std::vector<double>> columns(3, std::vector<double>(scans));
  const double keep = std::exp(-1.0 / hz);  // of what was a second ago a third is left
  double ml_mm = 0.0;
  double ap_mm = 0.0;
  for (std::size_t i = 0; i < scans; ++i) {
    const double time_s = static_cast<double>(i) / hz;
    ml_mm = keep * ml_mm + 3.0 * std::sqrt(1.0 - keep * keep) * noise(random);
    ap_mm = keep * ap_mm + 6.0 * std::sqrt(1.0 - keep * keep) * noise(random);
    columns[0][i] = 12.0 + ml_mm + 0.4 * std::sin(5.0 * time_s) + 0.02 * noise(random);
    columns[1][i] = -40.0 + ap_mm + 0.8 * std::sin(3.0 * time_s) + 0.02 * noise(random);
    columns[2][i] = 650.0 + noise(random);
  }
  Signal signal = make_signal(hz, "mm", columns);
  signal.format.name = "cop";
  signal.format.channels = {{.name = "ml_mm", .unit = "mm"}, {.name = "ap_mm", .unit = "mm"}, {.name = "load_n", .unit = "N"}};
  return signal;
}

/// At 1000 Hz, so that a block of the contract test lasts less than the shortest time between two running values. Faults: somebody who
/// steps on late and off early, gaps of 1 to 120 ms, and a value of one axis that is missing.
inline Signal standing_cop(std::size_t scans, std::uint64_t seed, Faults faults) {
  Signal signal = swaying_cop(1000.0, scans, seed);
  if (faults == Faults::None) return signal;
  std::mt19937_64 random(seed + 1);
  step_off(signal, 0, 30);
  step_off(signal, 130, 20);  // the state contract saves within this one and ...
  step_off(signal, 290, 70);  // ... within this one, in which the contract's trial ends
  for (std::size_t i = 30; i < scans; ++i) {
    if (random() % 150 == 0) step_off(signal, i, 1 + random() % 120);
    if (random() % 200 != 0) continue;
    signal.values[1][i] = std::numeric_limits<double>::quiet_NaN();
    signal.bits[1][i] |= core::quality::kRail;
  }
  if (scans > 40) step_off(signal, scans - 40, 40);
  return signal;
}

}  // namespace dts::pipeline
