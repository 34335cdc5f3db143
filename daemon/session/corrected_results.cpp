// SPDX-License-Identifier: Apache-2.0
#include "session/corrected_results.h"

#include <algorithm>
#include <iterator>
#include <tuple>

#include "events/make.h"
#include "record/old_event.h"
#include "record/recording.h"
#include "session/figure.h"
#include "session/reach_summary.h"
#include "session/recorded_reaches.h"
#include "session/session_events.h"
#include "session/standing_load.h"
#include "session/sway_results.h"

namespace dts::session {
namespace {

constexpr int kTrunkClasses = 3;  // minor, moderate, maximum

/// dtsd 0.1 recorded of a trial's reach only its number and flags, and of a class no probabilities.
bool is_of_dtsd_0_1(const v1::TrialResult& result) { return result.has_reach() && result.reach().step() == v1::REACH_STEP_UNSPECIFIED; }

/// Completes such a result from the steps of the reach in the recording. The probabilities stay unknown: results do not use them.
core::Status complete(const record::TrialRow& trial, const RecordedReaches& recorded, v1::TrialResult& result) {
  for (const RecordedReachTrial& attempt : recorded.attempts) {
    if (attempt.trial != trial.trial || attempt.attempt != trial.attempt || !attempt.result || !attempt.result->reach) continue;
    if (attempt.result->reach->number != result.reach().number()) continue;
    *result.mutable_reach() = events::to_message(*attempt.result->reach);
    while (result.has_movement() && result.movement().probability_size() < kTrunkClasses) result.mutable_movement()->add_probability(0.0);
    return {};
  }
  return core::fail(core::ErrorCode::DataDamaged,
                    "the reach of trial " + std::to_string(trial.trial) + " is not in the recording of session " + trial.session_id);
}

core::Result<RecordedReaches> reaches_in(const record::PartRow& part) {
  DTS_TRY_ASSIGN(const auto recording, record::Recording::open(part.file));
  return read_recorded_reaches(*recording, nullptr, [](double) {});
}

core::Result<std::vector<SessionFigure>> figures_of(const record::SessionRow& session, const record::PartRow& part) {
  std::optional<RecordedReaches> recorded;  // read for results of dtsd 0.1 only
  std::vector<SwayTrialResult> standing;
  std::vector<std::tuple<std::uint32_t, std::uint64_t, ReachTrialResult>> reaches;
  for (const record::TrialRow& trial : session.trials) {
    if (trial.part != part.part || trial.outcome != "done" || trial.result.empty()) continue;
    auto event = record::event_of_text(trial.result);
    if (!event) return core::fail(core::ErrorCode::DataDamaged, "the result of a trial of session " + session.id + " cannot be read");
    if (event->has_sway()) {
      DTS_TRY_ASSIGN(auto result, sway_of(*event));
      standing.push_back(std::move(result));
    } else if (event->has_trial_result()) {
      if (is_of_dtsd_0_1(event->trial_result())) {
        if (!recorded) {
          DTS_TRY_ASSIGN(recorded, reaches_in(part));
        }
        DTS_TRY(complete(trial, *recorded, *event->mutable_trial_result()));
      }
      DTS_TRY_ASSIGN(auto result, reach_result_of(*event));
      result.has_gap = trial.last_segment > trial.segment;
      reaches.emplace_back(trial.segment, trial.first_scan, std::move(result));
    }
  }
  std::vector<SessionFigure> figures;
  if (!reaches.empty()) {
    std::ranges::stable_sort(reaches, {}, [](const auto& reach) { return std::pair(std::get<0>(reach), std::get<1>(reach)); });
    std::vector<ReachTrialResult> results;
    for (auto& reach : reaches) results.push_back(std::move(std::get<2>(reach)));
    DTS_TRY_ASSIGN(const auto facts, record::read_session_facts(part.file));
    figures = summarize(results, person_of(facts.fields));
  }
  std::ranges::move(sway_summary(standing), std::back_inserter(figures));
  if (std::ranges::any_of(standing, [](const SwayTrialResult& trial) { return trial.mean_load_n.has_value(); })) {
    const auto facts = record::read_session_facts(part.file);
    const auto load = facts ? standing_load(standing, facts->fields) : std::nullopt;  // a lost file must not prevent a correction
    if (load) figures.push_back(to_figure(*load));
  }
  return figures;
}

}  // namespace

bool has_trial_results(const record::SessionRow& session) {
  return std::ranges::any_of(session.trials, [](const record::TrialRow& trial) { return !trial.result.empty(); });
}

core::Result<std::vector<record::ResultRow>> corrected_results(const record::SessionRow& session) {
  std::vector<record::ResultRow> results;
  for (const record::PartRow& part : session.parts) {
    if (!part.leads()) continue;
    DTS_TRY_ASSIGN(const auto figures, figures_of(session, part));
    for (const SessionFigure& figure : figures) {
      results.push_back({.session_id = session.id,
                         .name = figure.name + part_suffix(part.part),
                         .value = figure.value,
                         .unit = figure.unit,
                         .details = figure.details});
    }
  }
  return results;
}

}  // namespace dts::session
