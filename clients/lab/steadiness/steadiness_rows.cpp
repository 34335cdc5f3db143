// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/steadiness_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "lab/base/csv.h"
#include "lab/sway/measure_file.h"
#include "lab/sway/sway_view.h"
#include "posturography/cop_series.h"

namespace dts::lab::steadiness {
namespace {

using posturography::Measure;

constexpr std::array kTexts{"file", "session", "subject", "trial", "profile", "flags"};
constexpr std::array kNumbers{"fs_hz", "duration_s"};

bool is_text_column(const std::string& name) { return std::ranges::find(kTexts, name) != kTexts.end(); }

bool is_number_column(const std::string& name) {
  return std::ranges::find(kNumbers, name) != kNumbers.end() || posturography::measure_named(name).has_value();
}

std::vector<CsvColumn> columns_of(const std::string& label, const std::vector<std::string>& facts) {
  std::vector<CsvColumn> columns;
  for (const char* name : kTexts) columns.push_back({.name = name, .is_required = false, .is_text = true});
  if (!label.empty() && !is_text_column(label)) columns.push_back({.name = label, .is_required = false, .is_text = true});
  for (const std::string& fact : facts) {
    const bool is_known = std::ranges::find(columns, fact, &CsvColumn::name) != columns.end();
    if (!is_known) columns.push_back({.name = fact, .is_required = false, .is_text = true});
  }
  for (const char* name : kNumbers) {
    if (name != label) columns.push_back({.name = name, .is_required = false, .may_be_empty = true, .minimum = 0.0});
  }
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const std::string symbol(posturography::info(static_cast<Measure>(k)).symbol);
    if (symbol != label) columns.push_back({.name = symbol, .is_required = false, .may_be_empty = true});
  }
  return columns;
}

/// The names are joined by a bar.
bool has_invalid_flag(const std::string& flags) {
  const std::string framed = "|" + flags + "|";
  const auto names = posturography::names_of(posturography::sway_flag::kInvalid);
  return std::ranges::any_of(names, [&](std::string_view name) { return framed.find("|" + std::string(name) + "|") != std::string::npos; });
}

std::string text_at(const CsvTable& table, const std::string& column, std::size_t row) {
  const auto& texts = table.texts(column);
  return row < texts.size() ? texts[row] : std::string();
}

double number_at(const CsvTable& table, std::string_view column, std::size_t row) {
  const auto& numbers = table.numbers(column);
  return row < numbers.size() ? numbers[row] : std::numeric_limits<double>::quiet_NaN();
}

SteadinessRow row_of(const CsvTable& table, const std::string& label, const std::vector<std::string>& facts, std::size_t row) {
  SteadinessRow one{.line = CsvTable::line_of_row(row),
                    .file = text_at(table, "file", row),
                    .session = text_at(table, "session", row),
                    .subject = text_at(table, "subject", row),
                    .trial = text_at(table, "trial", row),
                    .label = label.empty() ? std::string() : text_at(table, label, row),
                    .profile = text_at(table, "profile", row),
                    .rate_hz = number_at(table, "fs_hz", row),
                    .duration_s = number_at(table, "duration_s", row),
                    .is_valid = !has_invalid_flag(text_at(table, "flags", row))};
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const auto measure = static_cast<Measure>(k);
    one.measures.set(measure, number_at(table, posturography::info(measure).symbol, row));  // an empty cell stays absent
  }
  for (const std::string& fact : facts) {
    if (table.has(fact)) one.facts[fact] = text_at(table, fact, row);
  }
  return one;
}

/// Adds "duration 20 to 60 s" if the known values differ by more than 1 %.
void add_span(const std::vector<SteadinessRow>& rows, double SteadinessRow::*member, const std::string& what, const std::string& unit,
              std::vector<std::string>& differences) {
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const SteadinessRow& row : rows) {
    if (!std::isfinite(row.*member)) continue;
    least = std::min(least, row.*member);
    most = std::max(most, row.*member);
  }
  if (most > 1.01 * least)
    differences.push_back(what + " from " + sway::significant(least, 4) + " to " + sway::significant(most, 4) + " " + unit);
}

}  // namespace

std::vector<SteadinessRow> read_rows(const std::string& file, const std::string& label, const std::vector<std::string>& facts,
                                     files::Problems& problems) {
  std::vector<SteadinessRow> rows;
  for (const std::string& fact : facts) {
    if (fact != label && is_number_column(fact))
      problems.push_back({file, 1, 1, "'" + fact + "' is a column of numbers: give another one"});
  }
  if (!problems.empty()) return rows;
  const CsvTable table = CsvTable::read(file, columns_of(label, facts), problems);
  if (!problems.empty()) return rows;
  bool has_measures = false;
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    has_measures = has_measures || table.has(posturography::info(static_cast<Measure>(k)).symbol);
  }
  if (!has_measures) {
    problems.push_back({file, 1, 1, "has no column of a measure: make such a table with dtslab sway FILES --table OUT.csv"});
    return rows;
  }
  if (!label.empty() && !table.has(label)) {
    problems.push_back({file, 1, 1, "column '" + label + "' is missing; dtslab sway FILES --label " + label + "=... adds it"});
    return rows;
  }
  for (std::size_t row = 0; row < table.row_count(); ++row) rows.push_back(row_of(table, label, facts, row));
  return rows;
}

core::Result<SteadinessRow> row_of_plates(const std::string& file, const force::CopChoice& choice, const std::string& profile,
                                          double rate_hz) {
  sway::SwayArguments arguments{.inputs = {file}, .cop = choice};
  if (!profile.empty()) arguments.profile = profile;
  if (rate_hz > 0.0) arguments.rate_hz = rate_hz;
  sway::MeasuredFile measured = sway::measure_file({.file = file}, arguments, [](double /*part*/) {});
  if (measured.error) return tl::make_unexpected(std::move(*measured.error));
  if (!measured.problems.empty()) return core::fail(core::ErrorCode::InvalidArgument, files::to_string(measured.problems.front()));
  const posturography::Analysis& analysis = *measured.trials.front().analysis;
  return SteadinessRow{.line = 1,
                       .file = file,
                       .profile = std::string(posturography::name(analysis.profile)),
                       .rate_hz = analysis.rate_hz,
                       .duration_s = analysis.duration_s,
                       .is_valid = analysis.is_valid(),
                       .measures = analysis.measures};
}

std::vector<std::string> differences_of(const std::vector<SteadinessRow>& rows) {
  std::vector<std::string> differences;
  std::set<std::string> profiles;
  for (const SteadinessRow& row : rows) {
    if (!row.profile.empty()) profiles.insert(row.profile);
  }
  if (profiles.size() > 1) {
    std::string text;
    for (const std::string& profile : profiles) text += (text.empty() ? "profiles " : ", ") + profile;
    differences.push_back(text);
  }
  add_span(rows, &SteadinessRow::duration_s, "duration", "s", differences);
  add_span(rows, &SteadinessRow::rate_hz, "rate", "Hz", differences);
  return differences;
}

}  // namespace dts::lab::steadiness
