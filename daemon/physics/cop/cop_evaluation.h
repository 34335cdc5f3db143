// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "physics/cop/cop_calibration.h"
#include "physics/cop/cop_estimator.h"
#include "physics/cop/cop_trials.h"
#include "physics/cop/sensed_plate.h"

// How well an estimator does on the model of a rig's plate: the error maps of plate-model section 5 and thesis Table 4.1.

namespace dts::physics {

enum class CopNoise : std::uint8_t {
  None,
  /// One filtered scan (plate-model section 5, "sensor model"): through the sensor's curve to volts, 3 mV rms noise, 4.88 mV steps,
  /// mean of three scans, back to mm; baseline from 100 scans of the unloaded plate.
  Realistic,
};

/// "none", "realistic"; fails with InvalidArgument for anything else.
[[nodiscard]] core::Result<CopNoise> parse_cop_noise(std::string_view name);

/// A trial, the estimate from its deflections, and estimate minus truth in `point`.
struct CopTrialError {
  CopCalibrationPoint point;
  CopEstimate estimate;
};

struct CopEvaluationOptions {
  PlateBehaviour behaviour = PlateBehaviour::Stiffening;
  CopNoise noise = CopNoise::None;
  std::uint64_t seed = 1;
  int divisions = InfluenceTable::kDefaultDivisions;
};

struct CopEvaluation {
  std::vector<CopTrialError> trials;  ///< In the order given.
  CopErrorFigures figures;            ///< Over the trials with contact.
  std::size_t no_contact_count = 0;
  std::size_t outside_count = 0;  ///< Flagged: outside the calibrated area or load range; they count in the figures.
};

/// Bends the rig's plate with each trial and compares. Fails when the plate cannot be made or the estimator is for another number
/// of sensors.
[[nodiscard]] core::Result<CopEvaluation> evaluate_cop(const RigModel& rig, const CopEstimator& estimator, std::span<const CopTrial> trials,
                                                       const CopEvaluationOptions& options = {});

}  // namespace dts::physics
