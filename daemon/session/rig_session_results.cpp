// SPDX-License-Identifier: Apache-2.0
// What a session with trials makes of reaches: cues to the subject, a result for each trial, figures at the end.
#include <utility>

#include "session/rig_session.h"

namespace dts::session {
namespace {

record::RecordedEvent recorded(const ReachTrialResult& result) {
  record::RecordedEvent out{.event = "result"};
  out.values.emplace_back("trial", std::int64_t{result.trial});
  out.values.emplace_back("attempt", std::int64_t{result.attempt});
  out.values.emplace_back("condition", result.condition);
  if (result.target_cm) out.values.emplace_back("target_cm", *result.target_cm);
  if (result.expected) out.values.emplace_back("expected_class", std::int64_t{static_cast<std::int8_t>(*result.expected)});
  if (result.reach) {
    out.values.emplace_back("number", std::int64_t{result.reach->number});
    out.values.emplace_back("flags", std::int64_t{result.reach->flags});
  }
  if (!result.movement) return out;
  out.values.emplace_back("class", std::int64_t{static_cast<std::int8_t>(result.movement->trunk_class)});
  out.values.emplace_back("trunk_deg", result.movement->trunk_deg);
  out.values.emplace_back("trunk_lo_deg", result.movement->trunk_lo_deg);
  out.values.emplace_back("trunk_hi_deg", result.movement->trunk_hi_deg);
  out.values.emplace_back("reasons", std::int64_t{result.movement->reasons});
  return out;
}

}  // namespace

void RigSession::give_cue(const TrialEvent& event) {
  if (event.kind != TrialEventKind::Ready && event.kind != TrialEventKind::Go) return;
  rig_.hear({.is_go = event.kind == TrialEventKind::Go, .at_ns = event.at_ns, .target_cm = event.target_cm.value_or(0.0)});
}

/// Takes what the pipeline noticed since the last time. The position is read first: everything before it is in the ring by then.
void RigSession::follow_reaches(const DataPosition& at) {
  const PipelineReport processed = rig_.pipeline_report();
  while (const core::FrameEvents* events = rig_.reaches().front()) {
    if (results_) {
      for (const core::ReachEvent& reach : events->reaches.all_of()) results_->take(reach);
      for (const core::ClassEvent& movement : events->classes.all_of()) results_->take(movement);
    }
    rig_.reaches().release();
  }
  if (!results_) return;
  results_->advance(processed.segment, processed.next_scan);
  tell_outcomes(at);
}

/// Into the recording, and beside the trial in the catalogue.
void RigSession::enter_result(const ReachTrialResult& result, bool is_at_end, const DataPosition& at) {
  record::RecordedEvent event = recorded(result);
  if (is_at_end) event.values.emplace_back("is_at_end", true);
  event.segment = at.segment;
  event.scan = at.scan;
  if (const auto row = trial_rows_.find({result.trial, result.attempt}); row != trial_rows_.end()) {
    row->second.result = record::to_json(event);
    put_trial(row->second);
  }
  note(std::move(event), at);
}

void RigSession::tell_outcomes(const DataPosition& at) {
  for (ReachTrialResult& result : results_->take_decided()) {
    enter_result(result, false, at);
    outcomes_.push_back({.result = std::move(result), .at = at});
  }
}

/// The session's trials are over: each is judged once more, by the subject's own scale if there is one now; and what came of them as a
/// whole. A resumed session has figures for each of its parts.
void RigSession::conclude(const DataPosition& at) {
  if (!results_) return;
  follow_reaches(at);
  results_->finish();
  tell_outcomes(at);
  for (const ReachTrialResult& result : results_->results()) enter_result(result, true, at);
  const std::uint32_t part = services_.recordings != nullptr ? services_.recordings->part(rig_.config().name) : 1;
  const std::string suffix = part > 1 ? "_part_" + std::to_string(part) : "";
  for (const ReachFigure& figure : results_->summary()) {
    const record::ResultRow row{.session_id = session_.view(0).id,
                                .name = figure.name + suffix,
                                .value = figure.value,
                                .unit = figure.unit,
                                .details = figure.details};
    note({.event = "figure", .values = {{"name", row.name}, {"value", row.value}, {"unit", row.unit}, {"details", row.details}}}, at);
    if (services_.recordings != nullptr) services_.recordings->enter_result(row);
  }
  results_.reset();
}

}  // namespace dts::session
