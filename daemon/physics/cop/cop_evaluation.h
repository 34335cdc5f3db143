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

// Measures the error of an estimator on the model of a rig's plate: the error maps of plate-model section 5 and thesis Table 4.1.

namespace dts::physics {

enum class CopNoise : std::uint8_t {
  None,
  /// One filtered scan (plate-model section 5, "sensor model"): through the sensor's curve to volts, 3 mV rms noise, 4.88 mV steps,
  /// mean of three scans, back to mm; baseline from 100 scans of the unloaded plate.
  Realistic,
};

/// Parses "none" or "realistic"; fails with InvalidArgument for anything else.
[[nodiscard]] core::Result<CopNoise> parse_cop_noise(std::string_view name);

/// A trial, the estimate from its deflections, and the error (estimate minus truth) in `point`.
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
  std::vector<CopTrialError> trials;  ///< In the order of the input.
  CopErrorFigures figures;            ///< Over the trials with contact.
  std::size_t no_contact_count = 0;
  std::size_t outside_count = 0;  ///< Outside the calibrated area or load range; they are included in the figures.
};

/// Computes the deflections for each trial and compares the estimate with the truth. Fails if the plate cannot be created or the estimator
/// needs another number of sensors.
[[nodiscard]] core::Result<CopEvaluation> evaluate_cop(const RigModel& rig, const CopEstimator& estimator, std::span<const CopTrial> trials,
                                                       const CopEvaluationOptions& options = {});

}  // namespace dts::physics
