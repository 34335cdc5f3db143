// SPDX-License-Identifier: Apache-2.0
#include "session/judges.h"

#include <algorithm>

#include "session/session_events.h"
#include "session/standing_load.h"

namespace dts::session {

void ReachJudge::take(const core::Event& event) {
  if (const auto* reach = std::get_if<core::ReachEvent>(&event)) results_.take(*reach);
  if (const auto* movement = std::get_if<core::ClassEvent>(&event)) results_.take(*movement);
}

std::vector<TrialResultEvent> ReachJudge::take_results() {
  std::vector<TrialResultEvent> events;
  for (const ReachTrialResult& result : results_.take_decided())
    events.push_back({.trial = result.trial, .attempt = result.attempt, .event = to_event(result, session_id_)});
  return events;
}

std::vector<TrialResultEvent> ReachJudge::final_results() const {
  std::vector<TrialResultEvent> events;
  for (const ReachTrialResult& result : results_.results()) {
    events.push_back({.trial = result.trial, .attempt = result.attempt, .event = to_event(result, session_id_)});
    events.back().event.mutable_trial_result()->set_is_at_end(true);
  }
  return events;
}

std::vector<TrialResultEvent> SwayJudge::take_results() {
  std::vector<TrialResultEvent> events;
  for (SwayTrialResult& result : results_.take_decided()) {
    result.decision = decider_.decide(result);
    if (!corrects_two_feet_) result.mean_load_n.reset();  // the sensors weigh a stance wrongly
    events.push_back({.trial = result.trial, .attempt = result.attempt, .event = to_event(result, session_id_, software_)});
  }
  return events;
}

std::vector<SessionFigure> SwayJudge::summary() const {
  std::vector<SessionFigure> figures = results_.summary();
  if (!corrects_two_feet_) return figures;
  if (const auto load = standing_load(results_.counting(), fields_)) figures.push_back(to_figure(*load));
  return figures;
}

std::vector<std::unique_ptr<TrialJudge>> make_judges(const Rig& rig, const record::SessionFacts& facts, const std::string& software,
                                                     core::Worker& worker) {
  std::vector<std::unique_ptr<TrialJudge>> judges;
  const auto& stages = rig.config().stages;
  if (std::ranges::find(stages, "reach", &pipeline::StageConfig::id) != stages.end()) {
    const auto& model = rig.config().trunk_model;
    judges.push_back(std::make_unique<ReachJudge>(facts.session_id, ReachResults(person_of(facts.fields), model ? &*model : nullptr)));
  }
  const bool corrects_two_feet = rig.config().cop_calibration && rig.config().cop_calibration->two_feet;
  if (const auto cop_rate = rig.cop_rate())
    judges.push_back(std::make_unique<SwayJudge>(facts, software, rig.config().rate, *cop_rate, corrects_two_feet,
                                                 rig.config().steadiness_model, worker));
  return judges;
}

}  // namespace dts::session
