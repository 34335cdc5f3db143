// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/join.h"
#include "report/measure_tables.h"
#include "report/number_text.h"
#include "report/page_parts.h"
#include "report/session_tables.h"
#include "report/spectrum_picture.h"
#include "report/stabilogram.h"
#include "report/sway_series.h"

namespace dts::report {
namespace {

constexpr double kStabilogramMm = 80.0;
constexpr double kSeriesMm = 43.0;
constexpr double kSpectraMm = 31.0;
constexpr std::size_t kMostDifferingNamed = 4;

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }

std::vector<Fact> facts_of(const SessionData& session, const TrialData& trial) {
  std::vector<Fact> facts;
  facts.push_back({.name = "Session", .value = or_dash(session.session_id())});
  facts.push_back({.name = "Subject ID", .value = session.facts ? or_dash(session.facts->subject) : "-"});
  facts.push_back({.name = "Rig", .value = session.facts ? or_dash(session.facts->rig) : "-"});
  facts.push_back({.name = "Protocol", .value = protocol_text(session)});
  facts.push_back({.name = "Condition", .value = condition_text(session, trial.recorded.condition)});
  facts.push_back({.name = "Labels", .value = or_dash(labels_text(trial))});
  facts.push_back({.name = "Outcome", .value = outcome_text(trial)});
  facts.push_back({.name = "Measured from", .value = trial.begins_utc_ns ? utc_text(*trial.begins_utc_ns) : "unknown"});
  if (trial.analysis) {
    facts.push_back({.name = "Analysed",
                     .value = fixed(trial.analysis->duration_s, 2) + " s, N = " + std::to_string(trial.analysis->samples) + " at " +
                              significant(trial.analysis->rate_hz) + " Hz"});
    facts.push_back(
        {.name = "Filter", .value = filter_text(*trial.analysis) + " (" + std::string(posturography::name(trial.analysis->profile)) + ")"});
  }
  if (session.facts && !session.facts->label.empty()) facts.push_back({.name = "Label", .value = session.facts->label});
  return facts;
}

std::vector<std::string> alerts_of(const SessionData& session, const TrialData& trial) {
  std::vector<std::string> alerts = session_alerts(session);
  if (!trial.is_kept()) {
    const std::string what = trial.recorded.outcome.empty() ? "did not end" : "was " + trial.recorded.outcome;
    alerts.push_back("This trial " + what + ": it is not valid.");
  }
  if (!trial.problem.empty()) alerts.push_back("No values: " + trial.problem + ".");
  if (trial.analysis && !trial.analysis->is_valid()) {
    alerts.emplace_back("Invalid: the subject stepped off or moved the feet. Do not use the values to judge steadiness.");
  }
  if (!trial.label(session::kFeedbackLabel).empty()) {
    alerts.emplace_back("With feedback: the subject saw the own COP. Do not compare this trial with trials without feedback.");
  }
  const std::string doubts = core::join(reference_warnings(trial), " ");
  if (!doubts.empty()) alerts.push_back(doubts);
  return alerts;
}

std::string differing_text(const TrialData& trial) {
  std::string names = core::join(std::views::take(trial.differing, kMostDifferingNamed));
  if (trial.differing.size() > kMostDifferingNamed) names += ", ...";
  return "Live values of the daemon and values computed now differ: " + std::to_string(trial.differing.size()) + " measures (" + names +
         ").";
}

Notes quality_notes(const SessionData& session, const TrialData& trial) {
  Notes notes{.title = "Quality and notes", .items = {}};
  if (trial.analysis) {
    for (std::uint32_t bit = 0; bit < posturography::sway_flag::kCount; ++bit) {
      const std::uint32_t flag = 1U << bit;
      if ((trial.analysis->flags & flag) == 0) continue;
      const auto names = posturography::names_of(flag);
      notes.items.push_back(std::string(posturography::sentence_of(flag)) + (names.empty() ? "" : " (" + std::string(names.front()) + ")"));
    }
    if (trial.analysis->flags == 0)
      notes.items.emplace_back("No problem found: the trial is long enough and has no gap, no jump and no doubtful sensor.");
    if (trial.analysis->missing > 0) {
      notes.items.push_back(std::to_string(trial.analysis->missing) + " of " + std::to_string(trial.recorded.cop.ml_mm.size()) +
                            " samples are missing; " + std::to_string(trial.analysis->interpolated) + " of them were interpolated.");
    }
    if (trial.recorded.live && trial.recorded.live->analysis && trial.differing.empty()) {
      notes.items.emplace_back("Live and recomputed values match.");
    }
  }
  if (!trial.differing.empty()) notes.items.push_back(differing_text(trial));
  notes.items.push_back(accuracy_note(session));
  notes.items.emplace_back(
      "AP: anterior-posterior, front is positive. ML: medio-lateral, right is positive. RD: distance from the mean. Unit 1: no unit. "
      "exp.: experimental, no agreed definition.");
  return notes;
}

std::string why_no_spectrum(const TrialData& trial) {
  if (!trial.analysis) return "the trial was not analysed";
  if ((trial.analysis->flags & posturography::sway_flag::kShortRecord) != 0) return "needs 10 s and 200 samples";
  return "the COP does not move";
}

std::vector<Block> left_pictures(const SessionData& session, const TrialData& trial) {
  if (!trial.prepared) return {};
  return {Figure{.title = "Stabilogram", .width_mm = kHalfWidthMm, .height_mm = kStabilogramMm, .draw = [&](Canvas& canvas) {
                   draw_stabilogram(canvas, kHalfWidthMm, kStabilogramMm, *trial.prepared, session.plate);
                 }}};
}

std::vector<Block> right_pictures(const TrialData& trial) {
  std::vector<Block> blocks;
  blocks.push_back(Figure{
      .title = "Centre of pressure against time", .width_mm = kHalfWidthMm, .height_mm = kSeriesMm, .draw = [&trial](Canvas& canvas) {
        draw_sway_series(canvas, kHalfWidthMm, kSeriesMm, trial.recorded.cop, trial.prepared ? &*trial.prepared : nullptr);
      }});
  if (!trial.analysis) return blocks;
  blocks.push_back(
      Figure{.title = "Power spectral density", .width_mm = kHalfWidthMm, .height_mm = kSpectraMm, .draw = [&trial](Canvas& canvas) {
               draw_spectra(canvas, kHalfWidthMm, kSpectraMm, trial.spectra, trial.analysis->measures, why_no_spectrum(trial));
             }});
  return blocks;
}

}  // namespace

PageContent trial_content(const SessionData& session, const TrialData& trial) {
  PageContent page;
  page.title = session_title(session) + (trial.recorded.trial == 0 ? "" : ", trial " + trial.number());
  page.subtitle = trial.recorded.condition.empty() ? "quiet standing" : condition_text(session, trial.recorded.condition);
  page.facts = facts_of(session, trial);
  page.alerts = alerts_of(session, trial);
  Section pictures{.columns = {left_pictures(session, trial), right_pictures(trial)}};
  Section numbers{.columns = {{}, {}}};
  if (trial.analysis) {
    numbers.columns[0].push_back(core_measures(trial));
    numbers.columns[1].push_back(all_measures(trial));
  }
  if (auto decision = decision_table(session, std::span(&trial, 1))) numbers.columns[0].push_back(std::move(*decision));
  numbers.columns[0].push_back(quality_notes(session, trial));
  page.sections = {std::move(pictures), std::move(numbers)};
  page.sections.back().columns[0].push_back(provenance_notes(provenance_of(session, trial.part, trial.part + 1)));
  if (auto methods = methods_of(session, std::span(&trial, 1))) page.sections.back().columns[0].push_back(std::move(*methods));
  return page;
}

}  // namespace dts::report
