// SPDX-License-Identifier: Apache-2.0
#include "core/join.h"
#include "report/chair_parts.h"
#include "report/chair_pictures.h"
#include "report/chair_tables.h"
#include "report/chair_words.h"
#include "report/number_text.h"
#include "report/page_parts.h"

namespace dts::report {
namespace {

constexpr double kTransientMm = 80.0;
constexpr double kScaleMm = 24.0;

std::string distance_text(const ChairData& chair, const ChairTrial& trial) {
  if (!trial.recorded.target_cm) return "-";
  std::string text = fixed(*trial.recorded.target_cm, 1) + " cm";
  if (chair.person && chair.person->arm_length_cm > 0.0)
    text += ", " + fixed(100.0 * *trial.recorded.target_cm / chair.person->arm_length_cm, 0) + " % of the arm's length";
  return text;
}

std::vector<Fact> facts_of_reach(const ChairData& chair, const ChairTrial& trial) {
  const auto known = [](const std::string& text) { return text.empty() ? std::string("-") : text; };
  std::vector<Fact> facts{{.name = "Session", .value = known(chair.session_id())},
                          {.name = "Subject ID", .value = chair.facts ? known(chair.facts->subject) : "-"},
                          {.name = "Rig", .value = chair.facts ? known(chair.facts->rig) : "-"},
                          {.name = "Protocol", .value = protocol_text(chair)},
                          {.name = "Target", .value = target_text(chair, trial.recorded.condition)},
                          {.name = "Distance", .value = distance_text(chair, trial)},
                          {.name = "Outcome", .value = outcome_of(trial)},
                          {.name = "Cue at", .value = trial.cue_utc_ns ? utc_text(*trial.cue_utc_ns) : "unknown"},
                          {.name = "Block", .value = std::to_string(trial.recorded.block)}};
  if (chair.facts && !chair.facts->label.empty()) facts.push_back({.name = "Label", .value = chair.facts->label});
  return facts;
}

std::vector<std::string> alerts_of_reach(const ChairData& chair, const ChairTrial& trial) {
  std::vector<std::string> alerts = session_alerts(chair);
  if (trial.recorded.outcome != "done") {
    alerts.push_back("This trial was " + trial.recorded.outcome + ": it is not valid.");
  } else if (const std::string fault = fault_of_reach(trial); !fault.empty()) {
    alerts.push_back("Not valid: " + fault + ".");
  }
  if (trial.recorded.end_segment != trial.recorded.segment) alerts.emplace_back("Scans are missing in this trial: it has no result.");
  return alerts;
}

Notes quality_of_reach(const ChairData& chair, const ChairTrial& trial) {
  Notes notes{.title = "Quality and notes", .items = {}};
  const core::TrunkMovement* movement = trial.movement();
  if (movement != nullptr && movement->trunk_class == core::TrunkClass::Rejected) {
    const auto reasons = static_cast<std::uint16_t>(movement->reasons & ~core::class_reason::kCalibrated);
    notes.items.push_back("No trunk class: " + core::join(reason_words(reasons), "; ") + ".");
  } else if (movement != nullptr && (movement->reasons & core::class_reason::kMinor) != 0) {
    notes.items.emplace_back("A minor reach gets at most the class minor.");
  }
  if (const core::ReachEvent* reach = trial.reach()) {
    const auto doubts = flag_words(reach->flags);
    notes.items.push_back(doubts.empty() ? "No doubt about the reach." : "About the reach: " + core::join(doubts, "; ") + ".");
    if (reach->resumed > 0) notes.items.push_back("The reach continued " + std::to_string(reach->resumed) + " times after a pause.");
  }
  if (trial.recorded.is_compared)
    notes.items.emplace_back(trial.recorded.differs ? "Live values of the daemon and values computed now differ."
                                                    : "Live and recomputed values match.");
  notes.items.push_back(model_note(chair));
  notes.items.push_back(explanation_of_chair());
  return notes;
}

}  // namespace

PageContent trial_content(const ChairData& chair, const ChairTrial& trial) {
  PageContent page{.title = session_title(chair) + ", trial " + trial.number(),
                   .subtitle = target_text(chair, trial.recorded.condition),
                   .facts = facts_of_reach(chair, trial),
                   .alerts = alerts_of_reach(chair, trial),
                   .sections = {}};
  page.sections.push_back(
      {.columns = {{Figure{.title = "Deflection of the seat: grey as recorded, blue mean over 50 ms; shaded: reach initiation",
                           .width_mm = kFullWidthMm,
                           .height_mm = kTransientMm,
                           .draw = [&trial](Canvas& canvas) { draw_transient(canvas, kFullWidthMm, kTransientMm, trial); }}}}});
  Section numbers{.columns = {{movement_table(chair, trial)}, {feature_table(trial), quality_of_reach(chair, trial)}}};
  if (trial.movement() != nullptr) {
    numbers.columns[0].push_back(Figure{
        .title = "Trunk angle with its 90 % interval", .width_mm = kHalfWidthMm, .height_mm = kScaleMm, .draw = [&trial](Canvas& canvas) {
          draw_trunk_scale(canvas, kHalfWidthMm, kScaleMm, trial);
        }});
  }
  numbers.columns[0].push_back(provenance_of_chair(chair, trial.part, trial.part + 1));
  numbers.columns[0].push_back(methods_of_chair(chair));
  page.sections.push_back(std::move(numbers));
  return page;
}

}  // namespace dts::report
