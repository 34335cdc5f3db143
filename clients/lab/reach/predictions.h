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

/// What is said of one trial.
struct Prediction {
  std::string subject;
  std::uint32_t trial = 0;
  core::Rate rate;                              ///< Of the scans of `reach`, counted from the trial's first.
  std::optional<core::ReachEvent> reach;        ///< Nothing: none was found.
  std::optional<core::TrunkMovement> movement;  ///< Nothing: it was not classified.
};

/// subject,trial,t_p1,t_p2,t_p3,p1_mm,p2_mm,p3_mm,class,p_class,trunk_deg,trunk_lo_deg,trunk_hi_deg and one line per prediction. Times in
/// s from the trial's first sample; what is not known stays empty. class is -1 when rejected, 0 without trunk movement; p_class is the
/// probability of the class that is given, empty for 0 and -1.
[[nodiscard]] std::string prediction_text(std::span<const Prediction> predictions);

/// Writes it to `file`, whole or not at all.
[[nodiscard]] core::Status write_predictions(std::span<const Prediction> predictions, const std::string& file);

}  // namespace dts::lab::reach
