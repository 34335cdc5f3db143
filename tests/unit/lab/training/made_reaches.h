// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "lab/training/random.h"
#include "lab/training/training_set.h"

namespace dts::lab::training {

/// People whose d2 / P1 is proportional to the sine of the trunk's angle, each with a gain of his own, 15 reaches to each target.
inline TrainingSet made_reaches(std::size_t people, std::uint64_t seed) {
  TrainingSet set;
  Random random(seed);
  const double target_deg[] = {0.0, 0.0, 4.0, 26.0, 54.0};
  for (std::size_t subject = 0; subject < people; ++subject) {
    set.subjects.push_back({.name = "P" + std::to_string(subject), .max_flexion_deg = 54.0});
    const double gain = random.uniform(0.65, 0.85);
    const double p1_mm = random.uniform(2.8, 4.6);
    for (int trial = 0; trial < 75; ++trial) {
      const int target = trial % 5;
      const double deg = std::max(0.0, target_deg[target] + (target < 2 ? 0.0 : random.uniform(-3.0, 3.0)));
      const double sine = std::sin(deg * std::numbers::pi / 180.0);
      const double d2 = 0.04 + gain * sine + random.uniform(-0.02, 0.02);
      const double d1 = target < 2 ? random.uniform(0.0, 0.01) : random.uniform(0.03, 0.09);
      TrainingReach reach{
          .subject = subject, .features = {}, .wanted = static_cast<core::TrunkClass>(std::max(0, target - 1)), .flexion_deg = deg};
      reach.features = {.p1_mm = p1_mm,
                        .p2_mm = p1_mm * (1.0 - d1),
                        .p3_mm = p1_mm * (1.0 + d2),
                        .hold_mm = 0.9 * d2 * p1_mm,
                        .rise_s = 0.6 + 0.01 * deg,
                        .rest_ratio = -0.2 + 0.002 * (trial % 7),
                        .ratio_change = 0.2 * sine + random.uniform(-0.005, 0.005)};
      set.reaches.push_back(reach);
    }
  }
  return set;
}

}  // namespace dts::lab::training
