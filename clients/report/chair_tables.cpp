// SPDX-License-Identifier: Apache-2.0
#include "report/chair_tables.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/join.h"
#include "core/special_numbers.h"
#include "report/chair_pictures.h"
#include "report/chair_words.h"
#include "report/number_text.h"
#include "report/page_parts.h"
#include "report/result_names.h"

namespace dts::report {
namespace {

using core::TrunkClass;

std::string number_or_dash(const std::optional<double>& value, int decimals) { return value ? fixed(*value, decimals) : "-"; }

/// "2.41 (0.12)": mean and standard deviation.
std::string spread_text(const session::Spread& spread, int decimals) {
  if (!spread.mean) return "-";
  return fixed(*spread.mean, decimals) + (spread.deviation ? " (" + fixed(*spread.deviation, decimals) + ")" : "");
}

std::string share_text(std::size_t part, std::size_t whole) {
  if (whole == 0) return "-";
  return std::to_string(part) + " of " + std::to_string(whole);
}

std::string percent_text(double part, double whole) {
  if (!std::isfinite(part) || !(whole > 0.0)) return "-";
  return fixed(100.0 * part / whole, 0) + " %";
}

std::vector<std::string> row_of_reach(const ChairData& chair, const ChairTrial& trial) {
  const core::ReachEvent* reach = trial.reach();
  const core::TrunkMovement* movement = trial.movement();
  const auto feature = [reach](double (*get)(const core::ReachFeatures&), int decimals) {
    return reach == nullptr ? std::string("-") : fixed(get(reach->features), decimals);
  };
  return {trial.number(),
          target_text(chair, trial.recorded.condition),
          number_or_dash(trial.recorded.target_cm, 1),
          outcome_of(trial),
          class_of(trial),
          class_word(trial.recorded.result ? trial.recorded.result->expected : std::nullopt),
          movement == nullptr ? "-" : fixed(movement->trunk_deg, 1),
          movement == nullptr ? "-" : interval_text(*movement),
          feature([](const core::ReachFeatures& of) { return of.d1_mm(); }, 2),
          feature([](const core::ReachFeatures& of) { return of.d2_mm(); }, 2),
          feature([](const core::ReachFeatures& of) { return of.rise_s; }, 2),
          feature([](const core::ReachFeatures& of) { return of.smoothness; }, 2)};
}

/// What a result of the session means, for its row.
constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kMeanings{
    {{"trials", "done, not redone and not rejected"},
     {"reaches_detected_share", "of the trials without missing scans"},
     {"rejected_share", "of the reaches that the model judged"},
     {"class_agreement_share", "of the reaches with a class, and of trials without a reach where none is expected"},
     {"trunk_at_critical_boundary_deg", "mean over the reaches to the target nearest to 1.15 arm lengths"},
     {"trunk_sd_deg", "consistency: pooled over the targets; a smaller value is more consistent"},
     {"d2_sd_mm", "consistency: pooled over the targets; a smaller value is more consistent"},
     {"sparc_mean", "spectral arc length of the seat's movement from P1 to P3; mean over all reaches"}}};

std::string why_no_scale(const ChairData& chair) {
  if (!chair.person) return "unknown: the session lacks measures of the body";
  if (chair.person->has_stroke) return "not used after a stroke: the trunk also moves where the arm alone could reach";
  if (!chair.model) return "unknown: the recording has no model of trunk movement";
  return "unknown: needs three maximum reaches that agree";
}

}  // namespace

Table reach_table(const ChairData& chair, std::size_t most_rows) {
  Table table{.title = "Trials",
              .columns = {{.head = "Trial", .share = 1.3},
                          {.head = "Target", .share = 2.5},
                          {.head = "Distance, cm", .share = 1.0, .is_number = true},
                          {.head = "Outcome", .share = 2.2},
                          {.head = "Trunk class", .share = 1.4},
                          {.head = "Expected class", .share = 1.3},
                          {.head = "Trunk angle, \u00B0", .share = 0.9, .is_number = true},
                          {.head = "90 % interval, \u00B0", .share = 1.4, .is_number = true},
                          {.head = "Dip d1, mm", .share = 0.8, .is_number = true},
                          {.head = "Rise d2, mm", .share = 0.8, .is_number = true},
                          {.head = "P2 to P3, s", .share = 0.8, .is_number = true},
                          {.head = "Smooth- ness", .share = 0.9, .is_number = true}},
              .rows = {}};
  for (const ChairTrial& trial : chair.trials) {
    if (table.rows.size() >= most_rows) break;
    table.rows.push_back({.cells = row_of_reach(chair, trial), .is_heading = false, .link = trial.page});
  }
  if (chair.trials.size() > table.rows.size()) {
    table.footnotes.push_back(std::to_string(chair.trials.size() - table.rows.size()) + " more trials are only on their own pages.");
  }
  if (chair.trials.empty()) table.footnotes.emplace_back("No trial with a cue in this session.");
  return table;
}

Table class_table(const ChairData& chair) {
  Table table{.title = "Trunk class by target, trials that are done",
              .columns = {{.head = "Target", .share = 2.5},
                          {.head = "Distance, cm", .share = 1.1, .is_number = true},
                          {.head = "Trials", .share = 0.8, .is_number = true},
                          {.head = "Trunk classes", .share = 2.6},
                          {.head = "Class as expected", .share = 1.2, .is_number = true}},
              .rows = {}};
  for (const session::TargetSummary& target : chair.targets) {
    std::vector<std::string> classes;
    for (const TrunkClass each : {TrunkClass::None, TrunkClass::Minor, TrunkClass::Moderate, TrunkClass::Maximum, TrunkClass::Rejected}) {
      if (target.of(each) > 0) classes.push_back(class_word(each) + " " + std::to_string(target.of(each)));
    }
    if (target.found + target.gaps < target.trials)
      classes.push_back("no reach " + std::to_string(target.trials - target.gaps - target.found));
    if (target.gaps > 0) classes.push_back("scans missing " + std::to_string(target.gaps));
    table.rows.push_back({.cells = {target_text(chair, target.condition), number_or_dash(target.target_cm, 1),
                                    std::to_string(target.trials), core::join(classes), share_text(target.agreed, target.compared)}});
  }
  table.footnotes.emplace_back(
      "Expected class: from target distance and body measures. A reach with the arm alone and a very small trunk movement are hard to "
      "distinguish: \"minor\" where \"none\" is expected is common.");
  return table;
}

Table consistency_table(const ChairData& chair) {
  Table table{.title = "Consistency by target: mean (standard deviation)",
              .columns = {{.head = "Target", .share = 2.4},
                          {.head = "Trunk angle, \u00B0", .share = 1.6, .is_number = true},
                          {.head = "Rise d2, mm", .share = 1.6, .is_number = true},
                          {.head = "d2 of own maximum", .share = 1.2, .is_number = true},
                          {.head = "Smoothness", .share = 1.6, .is_number = true}},
              .rows = {}};
  for (const session::TargetSummary& target : chair.targets) {
    const bool is_own = std::ranges::none_of(chair.trials, [&target](const ChairTrial& trial) {
      return trial.counts() && trial.recorded.condition == target.condition && !trial.is_calibrated();
    });
    table.rows.push_back(
        {.cells = {target_text(chair, target.condition), spread_text(target.trunk_deg, 1), spread_text(target.d2_mm, 2),
                   chair.scale && is_own ? percent_text(target.d2_mm.mean.value_or(core::kNaN), chair.scale->max_d2_mm) : "-",
                   spread_text(target.sparc, 2)}});
  }
  table.footnotes.emplace_back("Angles without rejected reaches, unless nothing but their class is uncertain.");
  return table;
}

Table result_table(const ChairData& chair) {
  Table table{
      .title = "Results of the session",
      .columns = {{.head = "Result", .share = 2.4}, {.head = "Value", .share = 0.6, .is_number = true}, {.head = "Meaning", .share = 4.5}},
      .rows = {}};
  for (const session::SessionFigure& result : chair.summary) {
    const auto meaning = std::ranges::find(kMeanings, result.name, &std::pair<std::string_view, std::string_view>::first);
    if (meaning == kMeanings.end()) continue;  // the number of targets is in the other tables
    const bool is_share = result.name.ends_with("_share");
    const std::string unit = result.unit == "deg" ? " \u00B0" : result.unit == "1" ? "" : " " + result.unit;
    const std::string value = is_share                  ? fixed(100.0 * result.value, 0) + " %"
                              : result.name == "trials" ? fixed(result.value, 0)
                                                        : fixed(result.value, 2) + unit;
    std::string name = plain_name(result.name);
    if (const std::size_t cut = name.find(", share of 1"); is_share && cut != std::string::npos) name.resize(cut);
    table.rows.push_back({.cells = {name, value, std::string(meaning->second)}});
  }
  return table;
}

Table scale_table(const ChairData& chair) {
  Table table{.title = "Subject's own scale",
              .columns = {{.head = "From three maximum reaches", .share = 3.0}, {.head = "Value", .share = 1.2, .is_number = true}},
              .rows = {}};
  if (!chair.scale) {
    table.columns = {{.head = "Own scale: " + why_no_scale(chair), .share = 1.0}};
    table.footnotes.emplace_back("Without it, the classes are those of the general model.");
    return table;
  }
  table.rows.push_back({.cells = {"Rise d2, median", fixed(chair.scale->max_d2_mm, 2) + " mm"}});
  table.rows.push_back({.cells = {"Hold, median", fixed(chair.scale->max_hold_mm, 2) + " mm"}});
  table.rows.push_back({.cells = {"Trunk angle, from body measures", fixed(chair.scale->max_flexion_deg, 1) + " \u00B0"}});
  const auto general =
      std::ranges::count_if(chair.trials, [](const ChairTrial& trial) { return trial.movement() != nullptr && !trial.is_calibrated(); });
  table.footnotes.emplace_back(general == 0   ? "The classes and angles on this page use this scale."
                               : general == 1 ? "The class and angle of 1 trial use the general model instead of this scale."
                                              : "The classes and angles of " + std::to_string(general) +
                                                    " trials use the general model instead of this scale.");
  return table;
}

std::optional<Table> rejected_table(const ChairData& chair, std::size_t most_rows) {
  Table table{.title = "Rejected reaches: no trunk class",
              .columns = {{.head = "Trial", .share = 1.0},
                          {.head = "Target", .share = 2.0},
                          {.head = "Most probable class", .share = 1.6},
                          {.head = "Reasons", .share = 7.0}},
              .rows = {}};
  std::size_t more = 0;
  for (const ChairTrial& trial : chair.trials) {
    const core::TrunkMovement* movement = trial.movement();
    if (movement == nullptr || movement->trunk_class != TrunkClass::Rejected) continue;
    if (table.rows.size() >= most_rows) {
      ++more;
      continue;
    }
    const auto best = std::ranges::max_element(movement->probability);
    const auto best_class = static_cast<TrunkClass>(1 + (best - movement->probability.begin()));
    std::vector<std::string> why = reason_words(static_cast<std::uint16_t>(movement->reasons & ~core::class_reason::kCalibrated));
    std::ranges::move(flag_words(trial.reach()->flags), std::back_inserter(why));
    table.rows.push_back({.cells = {trial.number(), target_text(chair, trial.recorded.condition),
                                    class_word(best_class) + ", p " + fixed(*best, 2), core::join(why, "; ")},
                          .is_heading = false,
                          .link = trial.page});
  }
  if (more > 0) table.footnotes.push_back(std::to_string(more) + " more rejected reaches are in the table of trials.");
  if (table.rows.empty()) return std::nullopt;
  return table;
}

Table movement_table(const ChairData& chair, const ChairTrial& trial) {
  Table table{.title = "Trunk movement", .columns = {{.head = "Quantity", .share = 1.3}, {.head = "Value", .share = 1.7}}, .rows = {}};
  const auto& result = trial.recorded.result;
  const auto add = [&table](const std::string& name, const std::string& value) { table.rows.push_back({.cells = {name, value}}); };
  add("Trunk class", class_of(trial));
  add("Expected for this target", class_word(result ? result->expected : std::nullopt));
  const core::TrunkMovement* movement = trial.movement();
  if (movement == nullptr) return table;
  add("Probability", "minor " + fixed(movement->probability[0], 2) + ", moderate " + fixed(movement->probability[1], 2) + ", maximum " +
                         fixed(movement->probability[2], 2));
  add("Trunk angle at P3", std::isfinite(movement->trunk_deg) ? fixed(movement->trunk_deg, 1) + " \u00B0" : "-");
  const std::string interval = interval_text(*movement);
  add("90 % interval", interval == "-" ? interval : interval + " \u00B0");
  const bool is_own = trial.is_calibrated();
  add("Scale", is_own ? "the subject's own" : "general model");
  if (const auto& first = trial.recorded.first_movement; is_own && first && (first->reasons & core::class_reason::kCalibrated) == 0) {
    add("When the trial ended",
        class_word(first->trunk_class) + (std::isfinite(first->trunk_deg) ? ", " + fixed(first->trunk_deg, 1) + " \u00B0" : ""));
    table.footnotes.emplace_back("When the trial ended, the own scale was not known yet: general model.");
  }
  if (chair.scale && is_own && trial.reach() != nullptr)
    add("Rise d2 of own maximum", percent_text(trial.reach()->features.d2_mm(), chair.scale->max_d2_mm));
  return table;
}

Table feature_table(const ChairTrial& trial) {
  Table table{.title = "Points and features of the reach",
              .columns = {{.head = "Quantity", .share = 2.6},
                          {.head = "Value", .share = 1.0, .is_number = true},
                          {.head = "Unit", .share = 0.5},
                          {.head = "After the cue, s", .share = 1.0, .is_number = true}},
              .rows = {}};
  const core::ReachEvent* reach = trial.reach();
  if (reach == nullptr) {
    table.footnotes.emplace_back("No reach was found between the cue and the end of the trial.");
    return table;
  }
  const core::ReachFeatures& of = reach->features;
  const auto point = [&](const char* name, const core::ReachPoint& at) {
    table.rows.push_back({.cells = {name, fixed(at.value_mm, 2), "mm", fixed(trial.after_cue_s(at.scan), 2)}});
  };
  const auto add = [&](const char* name, double value, int decimals, const char* unit) {
    table.rows.push_back({.cells = {name, fixed(value, decimals), unit, ""}});
  };
  point("P1: start of the reach", reach->p1);
  point("P2: end of the reach initiation", reach->p2);
  point("P3: maximum", reach->p3);
  add("Dip d1 = P1 - P2", of.d1_mm(), 2, "mm");
  add("Rise d2 = P3 - P1", of.d2_mm(), 2, "mm");
  if (of.p1_mm > 0.0) add("Rise relative to the sitting load, d2 / P1", 100.0 * of.d2_mm() / of.p1_mm, 1, "%");
  add("Hold: mean near the maximum, above P1", of.hold_mm, 2, "mm");
  add("P2 to P3", of.rise_s, 2, "s");
  add("Shift of the load to the front (ratio change)", of.ratio_change, 3, "");
  add("Smoothness (spectral arc length)", of.smoothness, 2, "");
  return table;
}

}  // namespace dts::report
