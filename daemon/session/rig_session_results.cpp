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

/// Passes the new frames and their events to the judges.
void RigSession::drain() {
  if (judges_.empty()) {
    rig_.follow_without_limit();
    return frames_.start_at(rig_.pipeline_report().end);
  }
  for (const core::Frame* frame = frames_.front(); frame != nullptr; frame = frames_.front()) {
    const core::Block* const cop = rig_.cop_stream() ? &frame->streams[*rig_.cop_stream()] : nullptr;
    for (const auto& judge : judges_) {
      for (const core::Event& event : frames_.events()) judge->take(event);
      if (cop != nullptr && cop->count() > 0) judge->take(*cop);
    }
    frames_.release();
  }
  rig_.note_followed(frames_.position().frame);
  if (frames_.lost_frames() > 0) {
    services_.recordings.mark_incomplete(rig_.config().name, "dtsd was too busy for the results; compute them again from the file");
  }
}

/// Processes what the pipeline found since the last call. Reads the position first: everything before it is in the rings by then.
void RigSession::follow(const DataPosition& at) {
  const PipelineReport processed = rig_.pipeline_report();
  drain();
  for (const auto& judge : judges_) judge->advance(processed.end.segment, processed.next_scan);
  enter_results(at);
}

bool RigSession::is_analysing() const {
  return std::ranges::any_of(judges_, [](const auto& judge) { return judge->is_analysing(); });
}

/// Announces the measuring window of a trial to the stage `steadiness` as soon as it is known.
void RigSession::open_window(const TrialEvent& event, const DataPosition& at) {
  if (!rig_.cop_rate()) return;
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
  } else if (event.kind == Undone) {
    rig_.windows().reopen();
  }
}

/// Writes a result to the recording, and to its trial in the catalogue.
void RigSession::enter_result(TrialResultEvent& result, const DataPosition& at) {
  place(result.event, at);
  if (const auto known = trials_entered_.find({result.trial, result.attempt}); known != trials_entered_.end()) {
    known->second.row.result = wire::to_json(result.event);
    known->second.fault = record::fault_of(result.event);
    put_trial(known->second.row);
  }
  note(result.event, at);
}

void RigSession::enter_results(const DataPosition& at) {
  for (const auto& judge : judges_) {
    for (TrialResultEvent& result : judge->take_results()) {
      enter_result(result, at);
      const auto known = trials_entered_.find({result.trial, result.attempt});
      if (known != trials_entered_.end() && known->second.row.outcome != name(TrialEventKind::Done)) {
        known->second.withheld = std::move(result.event);  // live, the next attempt is shown
      } else {
        events_.push_back(std::move(result.event));
      }
    }
  }
}

/// Concludes the session's trials: enters the results that the end of the session has changed, and the results of the session. A resumed
/// session has such results for each part.
void RigSession::conclude(const DataPosition& at) {
  enter_results(at);
  std::vector<SessionFigure> figures;
  for (const auto& judge : judges_) {
    for (TrialResultEvent& result : judge->final_results()) enter_result(result, at);
    std::ranges::move(judge->summary(), std::back_inserter(figures));
  }
  enter_figures(figures, at);
  judges_.clear();
}

void RigSession::enter_figures(const std::vector<SessionFigure>& figures, const DataPosition& at) {
  const std::string suffix = part_suffix(services_.recordings.part(rig_.config().name));
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
