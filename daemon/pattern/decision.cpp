// SPDX-License-Identifier: Apache-2.0
#include "pattern/decision.h"

#include <cmath>

namespace dts::pattern {
namespace {

constexpr double kSameRate = 0.01;

bool is_comparable(const PatternModel& model, const Trial& trial) {
  const bool knows_profile = !model.profile.empty() && !trial.profile.empty();
  const bool knows_rate = model.rate_hz > 0.0 && trial.rate_hz > 0.0;
  return (!knows_profile || model.profile == trial.profile) && (!knows_rate || is_same_rate(trial.rate_hz, model.rate_hz));
}

}  // namespace

std::string_view name(Outcome outcome) noexcept {
  switch (outcome) {
    case Outcome::Decided: return "decided";
    case Outcome::Outside: return "outside";
    case Outcome::NotValid: return "not valid";
    case Outcome::Missing: return "missing";
    case Outcome::NotComparable: return "not comparable";
  }
  return "";
}

bool is_same_rate(double a_hz, double b_hz) noexcept { return std::abs(a_hz - b_hz) <= kSameRate * b_hz; }

Decision decide(const PatternModel& model, const Trial& trial) {
  Decision decision{.answer = classify(model.discriminant, trial.measures)};
  if (!trial.is_valid) {
    decision.outcome = Outcome::NotValid;
  } else if (!is_comparable(model, trial)) {
    decision.outcome = Outcome::NotComparable;
  } else if (!decision.answer.best) {
    decision.outcome = Outcome::Missing;
  } else {
    decision.outcome = decision.answer.outside.empty() ? Outcome::Decided : Outcome::Outside;
  }
  return decision;
}

core::Status check_for_rig(const PatternModel& model) {
  if (model.verdict == Verdict::Told) return {};
  return core::fail(core::ErrorCode::InvalidArgument,
                    "the model of '" + model.label + "' must not be shown: " + verdict_text(model) + " in people left out of the training",
                    "use a model whose label is distinguished; dtslab steadiness train prints the reason");
}

}  // namespace dts::pattern
