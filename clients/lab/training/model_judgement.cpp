// SPDX-License-Identifier: Apache-2.0
#include "lab/training/model_judgement.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "lab/reach/simulated_trials.h"
#include "lab/training/random.h"
#include "lab/training/simulated_people.h"

namespace dts::lab::training {
namespace {

using classifier::SubjectCalibration;
using classifier::TrunkModel;
using core::TrunkClass;
namespace class_reason = core::class_reason;

constexpr std::array kLimits = {0.0, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 0.98, 0.99};
constexpr std::array<std::uint16_t, 5> kReasons = {std::uint16_t{0}, class_reason::kUnsure, class_reason::kBadReach,
                                                   class_reason::kOutOfRange, class_reason::kDisagreement};

constexpr std::uint64_t kUnseenPeople = 4711;  ///< Use of a seed, so that no training has the same people.

/// A reach to a target beyond the arm.
struct Unseen {
  std::optional<core::ReachEvent> reach;
  TrunkClass wanted = TrunkClass::None;
  bool is_at_rest = false;  ///< The simulated trunk stayed at the back rest.
  const SubjectCalibration* own = nullptr;
};

bool is_right(const Unseen& one, TrunkClass answer) { return answer == one.wanted || (answer == TrunkClass::None && one.is_at_rest); }

core::TrunkMovement answer_of(const TrunkModel& model, const Unseen& one, bool is_own) {
  if (!one.reach) return {};
  return model.classify(one.reach->features, one.reach->flags, is_own ? one.own : nullptr);
}

Answers answers_of(const TrunkModel& model, const std::vector<Unseen>& reaches, bool is_own) {
  Answers answers;
  for (const Unseen& one : reaches) {
    const TrunkClass answer = answer_of(model, one, is_own).trunk_class;
    if (answer == TrunkClass::Rejected) continue;
    ++answers.kept;
    answers.right += is_right(one, answer) ? 1 : 0;
    answers.by_target += answer == one.wanted ? 1 : 0;
  }
  return answers;
}

bool is_guess_right(const TrunkModel& model, const Unseen& one, bool is_own) {
  return one.reach && is_right(one, model.best_guess(one.reach->features, one.reach->flags, is_own ? one.own : nullptr).trunk_class);
}

std::vector<JudgedReason> reasons_of(const TrunkModel& model, const std::vector<Unseen>& reaches) {
  std::vector<JudgedReason> reasons;
  for (const std::uint16_t reason : kReasons) reasons.push_back({.reason = reason});
  for (const Unseen& one : reaches) {
    const core::TrunkMovement movement = answer_of(model, one, false);
    if (movement.trunk_class != TrunkClass::Rejected) continue;
    for (JudgedReason& reason : reasons) {
      const bool applies = reason.reason == 0 ? !one.reach : one.reach && (movement.reasons & reason.reason) != 0;
      if (!applies) continue;
      ++reason.rejected;
      reason.right += is_guess_right(model, one, false) ? 1 : 0;
    }
  }
  std::erase_if(reasons, [](const JudgedReason& reason) { return reason.rejected == 0; });
  return reasons;
}

/// Returns the own scale of each person; empty where none is possible.
std::vector<std::optional<SubjectCalibration>> scales_of(const reach::TrialSet& set,
                                                         const std::vector<std::optional<core::ReachEvent>>& reaches) {
  std::vector<std::vector<core::ReachFeatures>> maximum(set.subjects.size());
  for (std::size_t k = 0; k < reaches.size(); ++k) {
    auto& own = maximum[set.trials[k].subject];
    const bool is_fit = set.trials[k].condition == "max" && reaches[k] && (reaches[k]->flags & classifier::kUnfitFlags) == 0;
    if (is_fit && own.size() < classifier::kCalibrationReaches) own.push_back(reaches[k]->features);
  }
  std::vector<std::optional<SubjectCalibration>> scales;
  for (std::size_t subject = 0; subject < maximum.size(); ++subject) {
    const physics::Person& person = set.subjects[subject].person;
    const auto scale = classifier::calibrate_subject(maximum[subject], physics::trunk_flexion_deg(person, person.max_reach_cm));
    scales.push_back(scale ? std::optional(*scale) : std::nullopt);
  }
  return scales;
}

}  // namespace

core::Result<Judgement> judge_model(const TrunkModel& model, const JudgementOptions& options, const std::function<void(double)>& progress) {
  if (options.people < 1 || options.people > 10'000) {
    return core::fail(core::ErrorCode::InvalidArgument, "cannot judge a model: the number of people is 1 to 10000");
  }
  const std::uint64_t seed = derived_seed(options.seed, kUnseenPeople);
  const reach::TrialPlan plan{
      .conditions = {"120", "150", "max"}, .trials_per_condition = options.trials, .between_people = options.between_people, .seed = seed};
  const auto people = invent_people(options.people, seed);
  DTS_TRY_ASSIGN(const auto simulated, reach::simulate_trials(people, plan, [&](double part) { progress(0.4 * part); }));
  const auto found = reach::find_reaches(simulated.set, [&](double part) { progress(0.4 + 0.6 * part); });
  const auto scales = scales_of(simulated.set, found);
  std::vector<Unseen> reaches;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const reach::Trial& trial = simulated.set.trials[k];
    const auto& scale = scales[trial.subject];
    reaches.push_back({.reach = found[k],
                       .wanted = reach::class_of_condition(trial.condition).value_or(TrunkClass::None),
                       .is_at_rest = simulated.trunk_deg[k] <= 0.0,
                       .own = scale ? &*scale : nullptr});
  }
  Judgement judgement{.options = options, .reaches = reaches.size(), .reasons = {}, .curve = {}};
  judgement.general = answers_of(model, reaches, false);
  judgement.own = answers_of(model, reaches, true);
  for (const Unseen& one : reaches) {
    judgement.guessed_right += is_guess_right(model, one, false) ? 1 : 0;
    judgement.own_guessed_right += is_guess_right(model, one, true) ? 1 : 0;
  }
  judgement.reasons = reasons_of(model, reaches);
  for (const double limit : kLimits) {
    classifier::TrunkModelForm form = model.form();
    form.reject_below = limit;
    DTS_TRY_ASSIGN(const auto other, TrunkModel::create(std::move(form)));
    judgement.curve.push_back(
        {.reject_below = limit, .general = answers_of(other, reaches, false), .own = answers_of(other, reaches, true)});
  }
  return judgement;
}

}  // namespace dts::lab::training
