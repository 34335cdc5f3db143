// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "pattern/discriminant.h"
#include "pattern/pattern_model.h"
#include "posturography/measure.h"

namespace dts::pattern {

/// What a model says about one trial. The numbers are those of `dts.v1.DecisionOutcome`.
enum class Outcome : std::uint8_t {
  Decided = 1,   ///< The trial is within the training: `Answer::best` is the decision.
  Outside,       ///< A measure is outside the training range; the probabilities are a guess.
  NotValid,      ///< The subject stepped off or moved the feet.
  Missing,       ///< The trial lacks a measure that the model needs.
  NotComparable  ///< The trial was analysed with another profile or rate than the training, or is longer or shorter.
};
/// Returns "decided", "outside", "not valid", "missing", "not comparable".
[[nodiscard]] std::string_view name(Outcome outcome) noexcept;

/// One trial with what a model must know about it.
struct Trial {
  const posturography::Measures& measures;
  std::string_view profile;  ///< Empty: unknown.
  double rate_hz = 0.0;      ///< 0 or not finite: unknown.
  double duration_s = 0.0;   ///< 0 or not finite: unknown.
  bool is_valid = true;      ///< Neither stepped off nor moved.
};

struct Decision {
  Outcome outcome = Outcome::Missing;
  Answer answer{};  ///< Also complete if the outcome is not Decided, as far as the measures allow.
};

/// Returns the decision of a model for one trial. `dtsd` and `dtslab steadiness classify` both call it, so that their answers are equal.
/// Thread: any.
[[nodiscard]] Decision decide(const PatternModel& model, const Trial& trial);

/// Returns whether two rates or two durations differ by at most 1 %; false for those that are not finite.
[[nodiscard]] bool is_alike(double a, double b) noexcept;

/// Checks that a rig may show the decisions of this model. Fails with InvalidArgument if the label was not told in people outside the
/// training (the message names the verdict), or if the profile, rate or duration of its trials is not known.
[[nodiscard]] core::Status check_for_rig(const PatternModel& model);

}  // namespace dts::pattern
