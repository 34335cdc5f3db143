// SPDX-License-Identifier: Apache-2.0
#include "pattern/decision.h"

#include <cmath>

namespace dts::pattern {
namespace {

constexpr double kAlike = 0.01;

bool is_comparable(const PatternModel& model, const Trial& trial) {
  const bool knows_profile = !model.profile.empty() && !trial.profile.empty();
  const auto may_be = [](double given, double trained) { return !(given > 0.0 && trained > 0.0) || is_alike(given, trained); };
  return (!knows_profile || model.profile == trial.profile) && may_be(trial.rate_hz, model.rate_hz) &&
         may_be(trial.duration_s, model.duration_s);
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

bool is_alike(double a, double b) noexcept { return std::abs(a - b) <= kAlike * b; }

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
  const std::string refused = "the model of '" + model.label + "' must not be shown: ";
  if (model.verdict != Verdict::Told)
    return core::fail(core::ErrorCode::InvalidArgument, refused + verdict_text(model) + " in people left out of the training",
                      "use a model whose label is distinguished; dtslab steadiness train prints the reason");
  const bool is_known = !model.profile.empty() && model.rate_hz > 0.0 && model.duration_s > 0.0;
  if (is_known) return {};
  return core::fail(core::ErrorCode::InvalidArgument, refused + "the profile, rate or duration of its training trials is unknown or mixed",
                    "train it with a table of dtslab sway --table, of trials with one profile, rate and duration");
}

}  // namespace dts::pattern
