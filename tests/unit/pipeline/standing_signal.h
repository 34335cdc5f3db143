// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/stage_runner.h"

namespace dts::pipeline {

enum class Faults { None, Some };

inline double quantised_v(double volts) {
  constexpr double kCodeV = 0.005;  // the thesis's 4.88 mV is a power of two: sums would be exact and their order would not show
  return kCodeV * std::round(volts / kCodeV);
}

/// Somebody who sways on the floor platform and now and then shifts the weight at once: sensor volts with 3 mV of noise in steps of
/// 5 mV. Loads stay inside the sensors' working range of 7..12 mm.
inline Signal swaying_volts(std::size_t scans, std::mt19937_64& random) {
  static const physics::RigModel rig = floor_rig();
  static const FloorPlate plate(rig, physics::PlateBehaviour::Linear);  // a thousand times quicker, and nobody asks where the person stood
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::vector<std::vector<double>> columns(4, std::vector<double>(scans));
  double load_n = 490.0;
  physics::Point position{{215.0}, {215.0}};
  for (std::size_t i = 0; i < scans; ++i) {
    if (uniform(random) < 0.01) {
      load_n = 250.0 + 350.0 * uniform(random);
      position = {{145.0 + 140.0 * uniform(random)}, {145.0 + 140.0 * uniform(random)}};
    }
    position.x = core::Millimetres{std::clamp(position.x.value + 0.3 * noise(random), 140.0, 290.0)};
    position.y = core::Millimetres{std::clamp(position.y.value + 0.3 * noise(random), 140.0, 290.0)};
    const auto deflection_mm = plate.deflection_mm(position, load_n);
    for (std::size_t c = 0; c < 4; ++c) {
      const core::Millimetres gap = rig.sensors[c].unloaded_gap - core::Millimetres{deflection_mm[c]};
      columns[c][i] = quantised_v(rig.sensors[c].curve.volts(gap).value + 0.003 * noise(random));
    }
  }
  return make_signal(100.0, "V", columns);
}

/// Lost values, values at the converter's end, doubts of the device, and at both ends of the signal 0.8 s of what shows that a
/// stage remembers more than it may: 45 N, just below the contact threshold, with one channel that stands still. The
/// first scan is faulty, so that a plate with so little on it is not tared.
inline void add_faults(Signal& signal, std::mt19937_64& random) {
  static const physics::RigModel rig = floor_rig();
  static const auto nearly_empty_mm = FloorPlate(rig).deflection_mm({{215.0}, {215.0}}, 45.0);
  constexpr std::size_t kEndScans = 80;
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (std::size_t i = 0; i < signal.scans(); ++i) {
    const bool is_end = i < kEndScans || i + kEndScans >= signal.scans();
    for (std::size_t c = 0; is_end && c < 4; ++c) {
      const core::Millimetres gap = rig.sensors[c].unloaded_gap - core::Millimetres{nearly_empty_mm[c]};
      signal.values[c][i] = quantised_v(rig.sensors[c].curve.volts(gap).value + (c == 0 ? 0.0 : 0.003 * noise(random)));
    }
    if (is_end) continue;
    if (uniform(random) < 0.01) {  // a whole scan, as the guard marks one
      for (auto& bits : signal.bits) bits[i] = core::quality::kRotation;
    }
    const std::size_t c = random() % 4;
    if (uniform(random) < 0.01) signal.values[c][i] = std::numeric_limits<double>::quiet_NaN();
    if (uniform(random) < 0.01) signal.values[c][i] = uniform(random) < 0.5 ? 5.0 : -5.0;
    if (uniform(random) < 0.01) signal.bits[c][i] = core::quality::kRotation;
  }
  if (signal.scans() > 0) signal.bits[1][0] = core::quality::kRotation;
}

inline Signal standing_volts(std::size_t scans, std::uint64_t seed, Faults faults) {
  std::mt19937_64 random(seed);
  Signal signal = swaying_volts(scans, random);
  if (faults == Faults::Some) add_faults(signal, random);
  return signal;
}

/// The same as deflections. A lost value has its reason, as every value a stage sees.
inline Signal standing_millimetres(std::size_t scans, std::uint64_t seed, Faults faults) {
  static const physics::RigModel rig = floor_rig();
  Signal signal = standing_volts(scans, seed, faults);
  for (std::size_t c = 0; c < 4; ++c) {
    signal.format.channels[c].unit = "mm";
    for (std::size_t i = 0; i < scans; ++i) {
      const core::Volts volts{signal.values[c][i]};
      if (std::isnan(volts.value)) signal.bits[c][i] |= core::quality::kOutOfRange;
      signal.values[c][i] = (rig.sensors[c].unloaded_gap - rig.sensors[c].curve.gap(volts)).value;
    }
  }
  return signal;
}

}  // namespace dts::pipeline
