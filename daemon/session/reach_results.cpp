// SPDX-License-Identifier: Apache-2.0
#include "session/reach_results.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pipeline/main_reach.h"
#include "session/reach_summary.h"

namespace dts::session {
namespace {

namespace flag = core::reach_flag;

/// A reach with one of these flags cannot set a person's scale. A resumed reach, or one without a dip, can: its height is still valid.
constexpr std::uint16_t kNoScale = flag::kMinor | flag::kBaselineUncertain | flag::kDipOnly | flag::kTimeout | flag::kSubstituted |
                                   flag::kSaturated | flag::kImplausible | flag::kStoodUp | flag::kUntared;

template <class Event>
void keep_newest(std::deque<Event>& events, const Event& event) {
  if (events.size() == ReachResults::kMostPending) events.pop_front();
  events.push_back(event);
}

bool is_measured(const core::ReachEvent& event) {
  const core::ReachFeatures& features = event.features;
  return std::isfinite(features.p1_mm) && std::isfinite(features.p2_mm) && std::isfinite(features.p3_mm);
}

}  // namespace

std::optional<physics::Person> person_of(const std::vector<std::pair<std::string, std::string>>& fields) {
  physics::Person person;
  const std::array<std::pair<const char*, double*>, 4> measures{{{"weight_kg", &person.weight_kg},
                                                                 {"height_cm", &person.height_cm},
                                                                 {"arm_length_cm", &person.arm_length_cm},
                                                                 {"max_reach_cm", &person.max_reach_cm}}};
  for (const auto& [name, measure] : measures) {
    const auto number = field_number(fields, name);
    if (!number || !std::isfinite(*number) || *number <= 0.0) return std::nullopt;
    *measure = *number;
  }
  person.has_stroke = std::ranges::find(fields, std::pair<std::string, std::string>("group", "stroke")) != fields.end();
  return person;
}

std::optional<core::TrunkClass> expected_class(const std::optional<physics::Person>& person, std::optional<double> target_cm) {
  if (!person || !target_cm) return std::nullopt;
  const double flexion_deg = physics::trunk_flexion_deg(*person, *target_cm);
  if (!std::isfinite(flexion_deg)) return std::nullopt;
  if (flexion_deg <= 0.0) return core::TrunkClass::None;
  if (flexion_deg < physics::kModerateFromDeg) return core::TrunkClass::Minor;
  return flexion_deg < physics::kMaximumFromDeg ? core::TrunkClass::Moderate : core::TrunkClass::Maximum;
}

void ReachResults::take(const core::ReachEvent& event) {
  // Provisional steps contain nothing that the final does not contain.
  const bool is_final = event.step == core::ReachStep::Final && is_measured(event);
  if (is_final || event.step == core::ReachStep::Cancelled) keep_newest(reaches_, event);
}

void ReachResults::take(const core::ClassEvent& event) { keep_newest(classes_, event); }

void ReachResults::take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan) {
  using enum TrialEventKind;
  const bool counts = event.kind == Go || event.kind == Done || event.kind == Redone || event.kind == Rejected || event.kind == Aborted ||
                      event.kind == Undone;
  if (!counts || event.trial == 0) return;
  const Key key{event.trial, event.attempt};
  if (!attempts_.contains(key)) {
    if (attempts_.size() >= kMostAttempts) return;
    undecided_.push_back(key);
  }
  Attempt& attempt = attempts_[key];
  if (event.kind == Go && !attempt.go) {
    attempt.go = Place{segment, scan};
    attempt.condition = event.condition;
    const bool has_target = event.target_cm && std::isfinite(*event.target_cm) && *event.target_cm > 0.0;
    attempt.target_cm = has_target ? event.target_cm : std::nullopt;
  } else if (event.kind == Done && !attempt.done) {
    attempt.done = Place{segment, scan};
  } else if (event.kind == Undone) {
    undo(key);
  } else if (event.kind != Go && event.kind != Done) {
    attempt.is_void = true;
  }
  if (complete_until_) decide_until(complete_until_);
}

/// The attempt is valid again, and later attempts of its trial are void.
void ReachResults::undo(const Key& key) {
  for (auto& [other, attempt] : attempts_) {
    if (other.first == key.first && other.second >= key.second) attempt.is_void = other.second > key.second;
  }
}

void ReachResults::advance(std::uint32_t segment, core::ScanIndex scan) {
  const Place place{segment, scan};
  if (!complete_until_ || *complete_until_ < place) complete_until_ = place;
  if (!undecided_.empty()) decide_until(complete_until_);
}

void ReachResults::finish() { decide_until(std::nullopt); }

void ReachResults::decide_until(const std::optional<Place>& place) {
  std::erase_if(undecided_, [&](const Key& key) {
    Attempt& attempt = attempts_[key];
    if (attempt.is_void) return false;  // it may be undone
    if (!attempt.go || !attempt.done || (place && *place < *attempt.done)) return false;
    decide(key, attempt);
    return true;
  });
}

void ReachResults::decide(const Key& key, Attempt& attempt) {
  attempt.is_decided = true;
  attempt.reach = reach_of(attempt);
  if (attempt.reach) attempt.live = class_of(*attempt.reach, *attempt.done);
  fresh_.push_back(result_of(key, attempt, own_scale()));
}

std::optional<core::ReachEvent> ReachResults::reach_of(const Attempt& attempt) const {
  if (attempt.go->segment != attempt.done->segment) return std::nullopt;  // a gap: its content is unknown
  std::vector<core::ReachEvent> candidates;
  for (const core::ReachEvent& event : reaches_) {
    if (event.segment != attempt.go->segment || event.scan >= attempt.done->scan) continue;
    const bool is_within = event.p2.scan >= attempt.go->scan && event.p2.scan < attempt.done->scan;
    if (is_within || event.step == core::ReachStep::Cancelled) candidates.push_back(event);
  }
  std::ranges::stable_sort(candidates, {}, &core::ReachEvent::scan);
  return pipeline::main_reach(candidates);
}

std::optional<core::TrunkMovement> ReachResults::class_of(const core::ReachEvent& reach, const Place& done) const {
  const core::ClassEvent* best = nullptr;
  for (const core::ClassEvent& event : classes_) {
    const bool is_its = event.segment == reach.segment && event.number == reach.number && event.scan >= reach.scan;
    if (!is_its || event.scan >= done.scan) continue;
    if (best == nullptr || event.scan < best->scan) best = &event;
  }
  return best == nullptr ? std::nullopt : std::optional(best->movement);
}

std::vector<const ReachResults::Attempt*> ReachResults::counting() const {
  std::vector<const Attempt*> all;
  for (const auto& [key, attempt] : attempts_) {
    if (attempt.is_decided && !attempt.is_void) all.push_back(&attempt);
  }
  std::ranges::stable_sort(all, {}, [](const Attempt* attempt) { return *attempt->go; });
  return all;
}

bool ReachResults::is_at_maximum(const Attempt& attempt) const {
  return person_ && attempt.target_cm && std::abs(*attempt.target_cm - person_->max_reach_cm) <= kSameTargetCm;
}

std::optional<classifier::SubjectCalibration> ReachResults::own_scale() const {
  if (!person_ || person_->has_stroke || model_ == nullptr) return std::nullopt;  // the geometric model is invalid after a stroke
  const double flexion_deg = physics::trunk_flexion_deg(*person_, person_->max_reach_cm);
  std::vector<core::ReachFeatures> maxima;
  for (const Attempt* attempt : counting()) {
    const bool is_usable = is_at_maximum(*attempt) && attempt->reach && (attempt->reach->flags & kNoScale) == 0;
    if (!is_usable) continue;
    maxima.push_back(attempt->reach->features);
    if (maxima.size() < classifier::kCalibrationReaches) continue;
    const auto last = std::span(std::as_const(maxima)).last(classifier::kCalibrationReaches);
    if (const auto scale = classifier::calibrate_subject(last, flexion_deg)) return *scale;
  }
  return std::nullopt;
}

ReachTrialResult ReachResults::result_of(const Key& key, const Attempt& attempt,
                                         const std::optional<classifier::SubjectCalibration>& scale) const {
  ReachTrialResult result{.trial = key.first,
                          .attempt = key.second,
                          .condition = attempt.condition,
                          .target_cm = attempt.target_cm,
                          .segment = attempt.go->segment,
                          .go = attempt.go->scan,
                          .has_gap = attempt.go->segment != attempt.done->segment,
                          .reach = attempt.reach,
                          .movement = attempt.live,
                          .expected = expected_class(person_, attempt.target_cm)};
  if (!attempt.reach || model_ == nullptr) return result;
  const core::ReachEvent& reach = *attempt.reach;
  if (scale) {
    result.movement = model_->classify(reach.features, reach.flags, &*scale);
  } else if (!result.movement) {
    result.movement = model_->classify(reach.features, reach.flags);
  }
  return result;
}

std::vector<ReachTrialResult> ReachResults::take_decided() {
  std::vector<ReachTrialResult> decided;
  std::erase_if(fresh_, [&](const ReachTrialResult& result) {
    const Attempt& attempt = attempts_.at({result.trial, result.attempt});
    if (!attempt.is_void) decided.push_back(result);
    return !attempt.is_void;
  });
  std::ranges::stable_sort(decided, {}, [](const ReachTrialResult& result) { return Place{result.segment, result.go}; });
  return decided;
}

std::vector<ReachTrialResult> ReachResults::results() const { return results_of(false); }

std::vector<ReachTrialResult> ReachResults::results_of_void_too() const { return results_of(true); }

std::vector<ReachTrialResult> ReachResults::results_of(bool with_void) const {
  std::vector<ReachTrialResult> all;
  const auto scale = own_scale();
  for (const auto& [key, attempt] : attempts_) {
    if (attempt.is_decided && (with_void || !attempt.is_void)) all.push_back(result_of(key, attempt, scale));
  }
  std::ranges::stable_sort(all, {}, [](const ReachTrialResult& result) { return Place{result.segment, result.go}; });
  return all;
}

std::vector<SessionFigure> ReachResults::summary() const { return summarize(results(), person_); }

}  // namespace dts::session
