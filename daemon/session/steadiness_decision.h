// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "dts/v1/stream.pb.h"
#include "pipeline/rig_config.h"
#include "session/sway_results.h"

namespace dts::session {

/// Decides the trials of one rig by its steadiness model. Thread: any; does not change.
class SteadinessDecider {
 public:
  /// `model`: nothing: no trial gets a decision.
  explicit SteadinessDecider(const std::optional<pipeline::SteadinessModel>& model);

  /// Returns the decision for a trial with an analysis; nothing if there is no model, no analysis, or the model does not decide trials with
  /// these labels; nor for a trial with feedback.
  [[nodiscard]] std::optional<v1::SteadinessDecision> decide(const SwayTrialResult& trial) const;

 private:
  std::optional<pipeline::SteadinessModel> model_;
  v1::SteadinessDecision facts_;  ///< What every decision of this model has.
};

}  // namespace dts::session
