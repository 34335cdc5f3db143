// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "core/rate.h"
#include "core/reach.h"
#include "core/result.h"

namespace dts::lab::reach {

/// The result for one trial.
struct Prediction {
  std::string subject;
  std::uint32_t trial = 0;
  core::Rate rate;                              ///< Of the scans of `reach`, which are counted from the trial's first scan.
  std::optional<core::ReachEvent> reach;        ///< Empty: no reach was found.
  std::optional<core::TrunkMovement> movement;  ///< Empty: not classified.
};

/// Returns the header subject,trial,t_p1,t_p2,t_p3,p1_mm,p2_mm,p3_mm,class,p_class,trunk_deg,trunk_lo_deg,trunk_hi_deg and one line per
/// prediction. Times are in s from the trial's first sample; unknown values are empty. class is -1 if rejected, 0 without trunk movement;
/// p_class is the probability of that class, empty for 0 and -1.
[[nodiscard]] std::string prediction_text(std::span<const Prediction> predictions);

/// Writes the predictions to `file`, completely or not at all.
[[nodiscard]] core::Status write_predictions(std::span<const Prediction> predictions, const std::string& file);

}  // namespace dts::lab::reach
