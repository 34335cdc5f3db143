// SPDX-License-Identifier: Apache-2.0
#include "report/session_tables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "report/decision_words.h"
#include "report/measure_tables.h"
#include "report/number_text.h"
#include "report/page_parts.h"
#include "report/result_names.h"

namespace dts::report {
namespace {

using posturography::info;
using posturography::Measure;

constexpr std::size_t kMostConditions = 6;  // side by side
constexpr std::size_t kMostTables = 4;
constexpr std::string_view kRomberg = "romberg/";

struct ShownMeasure {
  Measure measure;
  std::string_view head;
};
constexpr std::array kShown = {ShownMeasure{Measure::Mvelo, "Mean velocity (MVELO), mm/s"},
                               ShownMeasure{Measure::Rdist, "RMS distance (RDIST), mm"},
                               ShownMeasure{Measure::RdistAp, "RMS distance AP, mm"},
                               ShownMeasure{Measure::RdistMl, "RMS distance ML, mm"},
                               ShownMeasure{Measure::RangeAp, "Range AP, mm"},
                               ShownMeasure{Measure::RangeMl, "Range ML, mm"},
                               ShownMeasure{Measure::Pea95F, "95 % ellipse (PEA95-F), mm2"},
                               ShownMeasure{Measure::AreaSw, "Sway area (AREA-SW), mm2/s"},
                               ShownMeasure{Measure::Mfreq, "Mean freq. (MFREQ), Hz"}};

/// Healthy young and aged people, firm surface, eyes closed over open: median (5-95 %), computed from the BDS set (posturography sheet
/// section 6).
struct PublishedQuotient {
  Measure measure;
  std::string_view young;
  std::string_view aged;
};
constexpr std::array kPublished = {PublishedQuotient{Measure::Mvelo, "1.11 (0.80-1.32)", "1.03 (0.83-1.54)"},
                                   PublishedQuotient{Measure::Pea95F, "1.24 (0.62-1.73)", "0.98 (0.57-1.77)"},
                                   PublishedQuotient{Measure::AreaSw, "1.21 (0.73-1.86)", "1.03 (0.64-1.96)"}};

/// The published quotients are for two feet on a firm surface and nothing else; a stance without a surface counts as firm.
bool is_of_references(const std::string& stance) { return stance == "feet=two" || stance == "feet=two,surface=firm"; }

/// Returns a warning for trials with another duration than the published quotients; empty if there are none.
std::string other_duration(const SessionData& session) {
  constexpr double kPublishedS = 60.0;
  const auto other = std::ranges::find_if(session.trials, [](const TrialData& trial) {
    return trial.counts() && trial.analysis && std::abs(trial.analysis->duration_s - kPublishedS) > 1.0;
  });
  return other == session.trials.end() ? ""
                                       : " The trials of this session have " + fixed(other->analysis->duration_s, 1) +
                                             " s: do not compare them with the published values.";
}

bool is_romberg(const session::SessionFigure& result) { return result.unit == "1" && result.name.starts_with(kRomberg); }

/// Groups of results in the order of their first result, and their values by symbol.
struct Groups {
  std::vector<std::string> names;
  std::map<std::pair<std::string, std::string>, double> values;

  void add(const std::string& group, const std::string& symbol, double value) {
    if (std::ranges::find(names, group) == names.end()) names.push_back(group);
    values[{group, symbol}] = value;
  }
  [[nodiscard]] std::string text(const std::string& group, std::string_view symbol) const {
    const auto found = values.find({group, std::string(symbol)});
    return found == values.end() ? "-" : significant(found->second);
  }
};

/// Returns the measures that any group has, in the order of measures.
std::vector<Measure> measures_of(const Groups& groups) {
  std::vector<Measure> measures;
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    const bool is_there = std::ranges::any_of(groups.names, [&](const std::string& name) {
      return groups.values.contains({name, std::string(info(measure).symbol)});
    });
    if (is_there) measures.push_back(measure);
  }
  return measures;
}

std::string head_of(const SessionData& session, const std::string& condition) {
  const auto is_of_it = [&](const TrialData& trial) { return trial.counts() && trial.recorded.condition == condition; };
  const auto whole =
      std::ranges::count_if(session.trials, [&](const TrialData& trial) { return is_of_it(trial) && !trial.analysis->is_cut(); });
  // As in session::sway_summary: trials that a gap cut short are in the mean only if there is no other.
  const auto count = whole > 0 ? whole : std::ranges::count_if(session.trials, is_of_it);
  return (condition.empty() ? "no condition" : condition_text(session, condition)) + " (n = " + std::to_string(count) + ")";
}

Table means_of(const SessionData& session, const Groups& groups, std::size_t first, std::size_t end) {
  Table table{.title = "Mean per condition, valid trials",
              .columns = {{.head = "Measure", .share = 3.0}, {.head = "Unit", .share = 0.7}},
              .rows = {}};
  for (std::size_t index = first; index < end; ++index) {
    table.columns.push_back({.head = head_of(session, groups.names[index]), .share = 1.5, .is_number = true});
  }
  for (const Measure measure : measures_of(groups)) {
    Row row{.cells = {measure_label(measure), std::string(info(measure).unit)}};
    for (std::size_t index = first; index < end; ++index) row.cells.push_back(groups.text(groups.names[index], info(measure).symbol));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Table trial_table(const SessionData& session, std::size_t most_rows) {
  Table table{.title = "Trials",
              .columns = {{.head = "Trial", .share = 1.3}, {.head = "Condition", .share = 2.5}, {.head = "Outcome", .share = 2.3}},
              .rows = {}};
  table.columns.push_back({.head = "Duration, s", .share = 0.9, .is_number = true});
  for (const ShownMeasure& shown : kShown) table.columns.push_back({.head = std::string(shown.head), .share = 1.0, .is_number = true});
  for (const TrialData& trial : session.trials) {
    if (table.rows.size() >= most_rows) break;
    Row row{.cells = {trial.number(), condition_text(session, trial.recorded.condition), outcome_text(trial)},
            .is_heading = false,
            .link = trial.page};
    row.cells.push_back(trial.analysis ? fixed(trial.analysis->duration_s, 1) : "-");
    for (const ShownMeasure& shown : kShown) {
      const auto value = trial.analysis ? trial.analysis->measures.get(shown.measure) : std::nullopt;
      row.cells.push_back(value ? significant(*value) : "-");
    }
    table.rows.push_back(std::move(row));
  }
  if (session.trials.size() > table.rows.size()) {
    table.footnotes.push_back(std::to_string(session.trials.size() - table.rows.size()) + " more trials are only on their own pages.");
  }
  if (session.trials.empty())
    table.footnotes.emplace_back("No trial to analyse: no one stood still on the plate for 10 s without a break.");
  return table;
}

std::vector<Table> condition_tables(const SessionData& session) {
  Groups groups;
  for (const session::SessionFigure& result : session.summary) {
    if (is_romberg(result)) continue;
    const ResultName name = parts_of(result.name);
    if (!name.group.empty()) groups.add(name.group, name.symbol, result.value);  // else of the whole session, such as the load
  }
  std::vector<Table> tables;
  for (std::size_t first = 0; first < groups.names.size() && tables.size() < kMostTables; first += kMostConditions) {
    tables.push_back(means_of(session, groups, first, std::min(groups.names.size(), first + kMostConditions)));
  }
  return tables;
}

std::optional<Table> romberg_table(const SessionData& session) {
  Groups groups;
  for (const session::SessionFigure& result : session.summary) {
    if (!is_romberg(result)) continue;
    const ResultName name = parts_of(result.name.substr(kRomberg.size()));
    groups.add(name.group, name.symbol, result.value);
  }
  if (groups.names.empty()) return std::nullopt;
  Table table{.title = "Romberg quotient: eyes closed / eyes open", .columns = {{.head = "Measure", .share = 2.4}}, .rows = {}};
  if (groups.names.size() > kMostConditions) groups.names.resize(kMostConditions);
  for (const std::string& stance : groups.names) {
    table.columns.push_back({.head = stance.empty() ? "quotient" : stance_text(stance), .share = 1.2, .is_number = true});
  }
  const bool has_references = std::ranges::any_of(groups.names, is_of_references);
  if (has_references) {
    table.columns.push_back({.head = "published, young (1)", .share = 1.7, .is_number = true});
    table.columns.push_back({.head = "published, 60+ (2)", .share = 1.6, .is_number = true});
  }
  for (const Measure measure : measures_of(groups)) {
    Row row{.cells = {measure_label(measure)}};
    for (const std::string& stance : groups.names) row.cells.push_back(groups.text(stance, info(measure).symbol));
    const auto published = std::ranges::find(kPublished, measure, &PublishedQuotient::measure);
    if (has_references) {
      row.cells.emplace_back(published == kPublished.end() ? "" : published->young);
      row.cells.emplace_back(published == kPublished.end() ? "" : published->aged);
    }
    table.rows.push_back(std::move(row));
  }
  table.footnotes.emplace_back(
      "Computed from the means of trials with equal duration and equal stance. A quotient below 1 is common and not an error.");
  if (has_references) {
    table.footnotes.emplace_back(
        "Published: median (5-95 %), two feet, firm surface, 60 s; (1) 36 people aged 20 to 38, no illness, disability or fall "
        "reported; "
        "(2) 76 people aged 60 or more, illness allowed. Computed from Santos & Duarte 2016, PeerJ 4:e2648 (CC BY 4.0), another device. "
        "Not comparable with one foot, foam or other durations." +
        other_duration(session));
  }
  return table;
}

std::optional<Table> decision_table(const SessionData& session, std::span<const TrialData> trials) {
  if (session.for_record) return std::nullopt;
  Table table{.title = "Decision of the steadiness model, recorded live",
              .columns = {{.head = "Trial", .share = 1.0},
                          {.head = "Condition", .share = 1.8},
                          {.head = "Model", .share = 1.0},
                          {.head = "Sway resembles", .share = 3.2}},
              .rows = {}};
  const auto add_note = [&table](std::string note) {
    if (std::ranges::find(table.footnotes, note) == table.footnotes.end()) table.footnotes.push_back(std::move(note));
  };
  for (const TrialData& trial : trials) {
    if (!trial.is_kept() || !trial.recorded.live || !trial.recorded.live->decision) continue;
    const v1::SteadinessDecision& decision = *trial.recorded.live->decision;
    table.rows.push_back(
        {.cells = {trial.number(), condition_text(session, trial.recorded.condition), decision.label(), decision_text(decision)}});
    for (std::string& limit : decision_limits(decision)) {
      if (limit != kDecisionLimit) add_note(std::move(limit));
    }
  }
  if (table.rows.empty()) return std::nullopt;
  table.footnotes.emplace_back(kDecisionLimit);  // once, after the notes of all models
  return table;
}

}  // namespace dts::report
