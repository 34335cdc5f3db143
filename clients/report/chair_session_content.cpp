// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "report/chair_parts.h"
#include "report/chair_pictures.h"
#include "report/chair_tables.h"
#include "report/chair_words.h"
#include "report/page_parts.h"

namespace dts::report {
namespace {

constexpr double kReachesMm = 52.0;
constexpr double kAnglesMm = 62.0;
constexpr std::size_t kMostRejected = 200;
constexpr std::size_t kMostExcluded = 20;

Notes excluded_reaches(const ChairData& chair) {
  Notes notes{.title = "Excluded trials", .items = {}};
  std::set<std::uint32_t> valid;
  for (const ChairTrial& trial : chair.trials) {
    const bool is_valid = trial.is_valid();
    if (is_valid) valid.insert(trial.recorded.trial);
    if (!is_valid && notes.items.size() < kMostExcluded) notes.items.push_back("Trial " + trial.number() + ": " + outcome_of(trial) + ".");
  }
  std::string missing;
  std::size_t count = 0;
  for (std::uint32_t trial = 1; trial <= chair.planned_trials; ++trial) {
    if (valid.contains(trial)) continue;
    if (++count <= kMostExcluded) missing += (missing.empty() ? "" : ", ") + std::to_string(trial);
  }
  if (count > 0) {
    notes.items.push_back(std::to_string(count) + " of " + std::to_string(chair.planned_trials) +
                          " planned trials have no valid result: " + missing + (count > kMostExcluded ? ", ..." : "") + ".");
  }
  if (notes.items.empty()) notes.items.emplace_back("None.");
  return notes;
}

Notes notes_of(const ChairData& chair) {
  Notes notes{.title = "Notes", .items = {}};
  if (chair.differing > 0 || !chair.differing_results.empty()) {
    notes.items.push_back("Live values of the daemon and values computed now differ in " + std::to_string(chair.differing) + " of " +
                          std::to_string(chair.compared) + " trials and " + std::to_string(chair.differing_results.size()) +
                          " results of the session.");
  } else if (chair.compared > 0) {
    notes.items.push_back("Live and recomputed values match in " + std::to_string(chair.compared) +
                          (chair.compared == 1 ? " trial." : " trials."));
  }
  notes.items.push_back(std::to_string(chair.reaches) + " reaches were found in the whole session, inside or outside trials.");
  notes.items.push_back(model_note(chair));
  notes.items.push_back(explanation_of_chair());
  return notes;
}

/// The scale is from the recorded outcomes. Returns an alert for each reach to the maximum that does not count any more.
std::vector<std::string> scale_alerts(const ChairData& chair) {
  std::vector<std::string> alerts;
  if (!chair.scale || !chair.person) return alerts;
  for (const ChairTrial& trial : chair.trials) {
    const bool is_at_maximum =
        trial.recorded.target_cm && std::abs(*trial.recorded.target_cm - chair.person->max_reach_cm) <= session::kSameTargetCm;
    const bool is_taken_back = trial.recorded_outcome == "done" && trial.recorded.outcome != "done" && trial.reach() != nullptr;
    if (is_at_maximum && is_taken_back && trial.part == chair.scale_part && alerts.size() < kMostExcluded) {
      alerts.push_back("The own scale may contain the reach of trial " + trial.number() + ", which was corrected to " +
                       trial.recorded.outcome + ".");
    }
  }
  return alerts;
}

}  // namespace

PageContent session_content(const ChairData& chair, const SessionPageLimits& limits) {
  const auto valid = std::ranges::count_if(chair.trials, &ChairTrial::is_valid);
  PageContent page{.title = session_title(chair),
                   .subtitle = "reaching",
                   .facts = session_facts(chair, static_cast<std::size_t>(valid), {}),
                   .alerts = session_alerts(chair),
                   .sections = {}};
  std::ranges::move(scale_alerts(chair), std::back_inserter(page.alerts));
  if (!chair.targets.empty()) {
    page.sections.push_back({.columns = {{result_table(chair)}}});
    page.sections.push_back(
        {.columns = {{Figure{.title = "Reaches by target: change of the seat's deflection; red: rejected",
                             .width_mm = kFullWidthMm,
                             .height_mm = kReachesMm,
                             .draw = [&chair](Canvas& canvas) { draw_reaches(canvas, kFullWidthMm, kReachesMm, chair); }}}}});
    page.sections.push_back(
        {.columns = {{Figure{.title = "Trunk angle of each reach",
                             .width_mm = kHalfWidthMm,
                             .height_mm = kAnglesMm,
                             .draw = [&chair](Canvas& canvas) { draw_angles(canvas, kHalfWidthMm, kAnglesMm, chair); }}},
                     {class_table(chair), consistency_table(chair)}}});
  }
  page.sections.push_back({.columns = {{reach_table(chair, limits.trials)}}});
  if (auto rejected = rejected_table(chair, std::min(limits.trials, kMostRejected)))
    page.sections.push_back({.columns = {{std::move(*rejected)}}});
  if (chair.targets.size() > kMostTargetsDrawn) {
    page.alerts.push_back("The pictures show the first " + std::to_string(kMostTargetsDrawn) + " of " +
                          std::to_string(chair.targets.size()) + " targets. The tables show all.");
  }
  Section rest{.columns = {{scale_table(chair), methods_of_chair(chair)}, {excluded_reaches(chair), notes_of(chair)}}};
  if (auto corrections = corrections_of(chair); !corrections.items.empty()) rest.columns[1].push_back(std::move(corrections));
  rest.columns[0].push_back(provenance_of_chair(chair, 0, chair.parts.size()));
  page.sections.push_back(std::move(rest));
  return page;
}

}  // namespace dts::report
