// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/result.h"

namespace dts::lab::training {

struct JudgementOptions {
  std::size_t people = 60;
  int trials = 10;  ///< Per target.
  double between_people = 1.0;
  std::uint64_t seed = 1;
};

/// Answers of a model. All counts are of reaches to targets beyond the arm.
struct Answers {
  std::size_t kept = 0;       ///< Not rejected.
  std::size_t right = 0;      ///< The class of the target, or class 0 if the simulated trunk in fact stayed at the back rest.
  std::size_t by_target = 0;  ///< The class of the target.
};

/// Answers with one limit of the probability.
struct JudgedLimit {
  double reject_below = 0.0;
  Answers general;
  Answers own;  ///< With the scale of the person's first three maximum reaches.
};

/// Reaches that one reason rejects, at the model's own limit and without own scale. A reach may have several reasons.
struct JudgedReason {
  std::uint16_t reason = 0;  ///< core::class_reason; 0: no reach was found.
  std::size_t rejected = 0;
  std::size_t right = 0;  ///< How many of them the best guess has right.
};

struct Judgement {
  JudgementOptions options;
  std::size_t reaches = 0;
  Answers general;  ///< At the model's own limit.
  Answers own;
  std::size_t guessed_right = 0;  ///< Without any rejection.
  std::size_t own_guessed_right = 0;
  std::vector<JudgedReason> reasons;
  std::vector<JudgedLimit> curve;  ///< By limit, ascending.
};

/// Simulates people who are not those of `simulated_people`, whatever the seed, and counts its answers. Synthetic. Fails with
/// InvalidArgument if an option is invalid.
[[nodiscard]] core::Result<Judgement> judge_model(const classifier::TrunkModel& model, const JudgementOptions& options,
                                                  const std::function<void(double)>& progress);

}  // namespace dts::lab::training
