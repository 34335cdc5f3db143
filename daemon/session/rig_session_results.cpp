// SPDX-License-Identifier: Apache-2.0
// Results in a session with trials: cues to the subject, a result for each trial, results of the session at its end.
#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "dts/wire/event_json.h"
#include "session/rig_session.h"
#include "session/session_events.h"

namespace dts::session {
void RigSession::give_cue(const TrialEvent& event) {
  if (event.kind != TrialEventKind::Ready && event.kind != TrialEventKind::Go) return;
  rig_.hear({.is_go = event.kind == TrialEventKind::Go, .at_ns = event.at_ns, .target_cm = event.target_cm.value_or(0.0)});
}

/// Prepares the results of a new session. Empties the rings, whose content is from before the session.
void RigSession::prepare_results(const Protocol& protocol, const record::SessionFacts& facts) {
  reaches_.reset();
  sways_.reset();
  drain();
  if (!protocol.trials) return;
  plan_ = *protocol.trials;
  const auto& stages = rig_.config().stages;
  if (std::ranges::find(stages, "reach", &pipeline::StageConfig::id) != stages.end()) {
    const auto& model = rig_.config().trunk_model;
    reaches_.emplace(person_of(facts.fields), model ? &*model : nullptr);
  }
  if (const auto cop_rate = rig_.cop_rate()) sways_.emplace(rig_.config().rate, *cop_rate, services_.worker);
}

/// Empties the rings from the pipeline; passes their content to the results of the session, if any.
void RigSession::drain() {
  while (const core::Event* event = rig_.reaches().front()) {
    if (reaches_) {
      if (const auto* reach = std::get_if<core::ReachEvent>(event)) reaches_->take(*reach);
      if (const auto* movement = std::get_if<core::ClassEvent>(event)) reaches_->take(*movement);
    }
    rig_.reaches().release();
  }
  while (const core::Block* cop = rig_.cops().front()) {
    if (sways_) sways_->take(*cop);
    rig_.cops().release();
  }
}

/// Processes what the pipeline found since the last call. Reads the position first: everything before it is in the rings by then.
void RigSession::follow(const DataPosition& at) {
  const PipelineReport processed = rig_.pipeline_report();
  drain();
  if (reaches_) reaches_->advance(processed.segment, processed.next_scan);
  tell_outcomes(at);
}

/// Announces the measuring window of a trial to the stage `steadiness` as soon as it is known.
void RigSession::open_window(const TrialEvent& event, const DataPosition& at) {
  if (!sways_) return;
  using enum TrialEventKind;
  if (event.kind == Go) {
    const auto scans = [this](double s) { return s > 0.0 ? rig_.config().rate.scans_in_ms(s * 1e3) : 0; };
    const core::ScanIndex first = at.scan + scans(plan_.settle_s);
    const bool is_open_ended = plan_.duration_s <= 0.0;
    const core::ScanIndex end =
        is_open_ended ? core::ScanIndex{std::numeric_limits<std::uint64_t>::max()} : first + scans(plan_.duration_s);
    rig_.windows().open(event.trial, at.segment, first, end);
  } else if (event.kind == Done) {
    rig_.windows().end_at(at.segment, at.scan);
  } else if (event.kind == Redone || event.kind == Rejected || event.kind == Aborted) {
    rig_.windows().close();
  }
}

/// Writes a result to the recording, and to its trial in the catalogue.
void RigSession::enter_result(v1::Event event, std::uint32_t trial, std::uint32_t attempt, const DataPosition& at) {
  place(event, at);
  if (const auto row = trial_rows_.find({trial, attempt}); row != trial_rows_.end()) {
    row->second.result = wire::to_json(event);
    put_trial(row->second);
  }
  note(std::move(event), at);
}

void RigSession::tell_outcomes(const DataPosition& at) {
  if (reaches_) {
    for (ReachTrialResult& result : reaches_->take_decided()) {
      enter_result(to_event(result, session_.view(0).id), result.trial, result.attempt, at);
      outcomes_.push_back({.result = std::move(result), .at = at});
    }
  }
  if (sways_) {
    for (SwayTrialResult& result : sways_->take_decided()) {
      enter_result(to_event(result, session_.view(0).id, services_.software), result.trial, result.attempt, at);
      outcomes_.push_back({.result = std::move(result), .at = at});
    }
  }
}

/// Concludes the session's trials: classifies each reach again, on the subject's own scale if it is known now, and computes the results of
/// the session. A resumed session has such results for each part.
void RigSession::conclude(const DataPosition& at) {
  tell_outcomes(at);
  std::vector<SessionFigure> figures;
  if (reaches_) {
    for (const ReachTrialResult& result : reaches_->results()) {
      v1::Event event = to_event(result, session_.view(0).id);
      event.mutable_trial_result()->set_is_at_end(true);
      enter_result(std::move(event), result.trial, result.attempt, at);
    }
    figures = reaches_->summary();
  }
  if (sways_) std::ranges::move(sways_->summary(), std::back_inserter(figures));
  enter_figures(figures, at);
  reaches_.reset();
  sways_.reset();
}

void RigSession::enter_figures(const std::vector<SessionFigure>& figures, const DataPosition& at) {
  const std::uint32_t part = services_.recordings.part(rig_.config().name);
  const std::string suffix = part > 1 ? "_part_" + std::to_string(part) : "";
  for (const SessionFigure& figure : figures) {
    const record::ResultRow row{.session_id = session_.view(0).id,
                                .name = figure.name + suffix,
                                .value = figure.value,
                                .unit = figure.unit,
                                .details = figure.details};
    note(to_event(SessionFigure{.name = row.name, .value = row.value, .unit = row.unit, .details = row.details}), at);
    services_.recordings.enter_result(row);
  }
}

}  // namespace dts::session
