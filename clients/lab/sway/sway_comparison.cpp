// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_comparison.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "cli/table.h"
#include "lab/sway/sway_view.h"
#include "session/protocol.h"

namespace dts::lab::sway {
namespace {

using posturography::Analysis;
using posturography::Measure;

/// As in the session's own summary: durations may differ by one or two samples.
constexpr double kSameDurationS = 0.1;
constexpr double kSameRate = 0.01;  ///< Relative: path and direction are at least as sensitive to the rate.

bool is_equally_long(const Analysis& a, const Analysis& b) { return std::abs(a.duration_s - b.duration_s) <= kSameDurationS; }
bool is_equal_rate(const Analysis& a, const Analysis& b) { return std::abs(a.rate_hz - b.rate_hz) <= kSameRate * a.rate_hz; }
bool is_other_person(const MeasuredTrial& a, const MeasuredTrial& b) {
  return !a.subject.empty() && !b.subject.empty() && a.subject != b.subject;
}

Labels without_eyes(const MeasuredTrial& trial) {
  Labels labels = trial.labels;
  std::erase_if(labels, [](const auto& label) { return label.first == "eyes"; });
  std::ranges::sort(labels);
  return labels;
}

/// Returns whether the first trial is the one with open eyes; nothing if the two do not form a Romberg test.
std::optional<bool> is_first_open(const MeasuredTrial& a, const MeasuredTrial& b) {
  if (without_eyes(a) != without_eyes(b) || !a.analysis->is_valid() || !b.analysis->is_valid()) return std::nullopt;
  if (!is_equally_long(*a.analysis, *b.analysis) || !is_equal_rate(*a.analysis, *b.analysis) || is_other_person(a, b)) return std::nullopt;
  if (a.label("eyes") == "open" && b.label("eyes") == "closed") return true;
  if (a.label("eyes") == "closed" && b.label("eyes") == "open") return false;
  return std::nullopt;
}

void warn_of(const MeasuredTrial& trial, std::vector<std::string>& warnings) {
  if (!trial.analysis->is_valid()) warnings.push_back(trial.title() + " is not valid: the subject stepped off or moved the feet");
}

std::vector<std::string> warnings_of(const MeasuredTrial& a, const MeasuredTrial& b) {
  std::vector<std::string> warnings;
  warn_of(a, warnings);
  warn_of(b, warnings);
  if (!is_equally_long(*a.analysis, *b.analysis)) {
    warnings.push_back("durations differ (" + significant(a.analysis->duration_s) + " and " + significant(b.analysis->duration_s) +
                       " s): distances, areas and frequencies depend on it");
  }
  if (!is_equal_rate(*a.analysis, *b.analysis)) {
    warnings.push_back("rates differ (" + significant(a.analysis->rate_hz) + " and " + significant(b.analysis->rate_hz) +
                       " Hz): path, velocity and direction depend on it; use --rate to make them equal");
  }
  if (a.label(session::kFeedbackLabel) != b.label(session::kFeedbackLabel)) {
    warnings.emplace_back("only one of the trials has feedback: seeing the own COP changes sway, so do not compare them");
  }
  if (a.analysis->profile != b.analysis->profile) warnings.emplace_back("profiles differ: path and velocity depend on the filter");
  if (is_other_person(a, b)) warnings.emplace_back("the trials are from different people");
  return warnings;
}

std::optional<double> quotient(double numerator, double denominator) {
  if (numerator <= 0.0 || denominator <= 0.0) return std::nullopt;
  const double value = numerator / denominator;
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

Comparison compare(const MeasuredTrial& first, const MeasuredTrial& second) {
  Comparison comparison{.measures = {}, .warnings = warnings_of(first, second)};
  const std::optional<bool> first_open = is_first_open(first, second);
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const auto measure = static_cast<Measure>(k);
    const auto a = first.analysis->measures.get(measure);
    const auto b = second.analysis->measures.get(measure);
    const auto& about = posturography::info(measure);
    if (!about.is_core || !a || !b) continue;
    ComparedMeasure compared{.measure = measure, .first = *a, .second = *b};
    if (about.is_ratio_scaled) {
      if (const auto ratio = quotient(*b, *a)) compared.percent = 100.0 * (*ratio - 1.0);
      if (first_open) compared.romberg = *first_open ? quotient(*b, *a) : quotient(*a, *b);
    }
    comparison.has_romberg = comparison.has_romberg || compared.romberg.has_value();
    comparison.measures.push_back(compared);
  }
  return comparison;
}

cli::Json to_json(const Comparison& comparison) {
  cli::Json json{{"measures", cli::Json::object()}};
  for (const ComparedMeasure& compared : comparison.measures) {
    const auto& about = posturography::info(compared.measure);
    cli::Json& one = json["measures"][std::string(about.symbol)];
    one = {{"first", compared.first}, {"second", compared.second}, {"difference", compared.second - compared.first}};
    if (compared.percent) one["percent"] = *compared.percent;
    one["unit"] = about.unit;
    if (compared.romberg) json["romberg"][std::string(about.symbol)] = *compared.romberg;
  }
  json["warnings"] = comparison.warnings;
  return json;
}

void print(const Comparison& comparison, const MeasuredTrial& first, const MeasuredTrial& second, cli::Console& console) {
  console.out << "FIRST:  " << cli::printable(first.title()) << "\nSECOND: " << cli::printable(second.title()) << "\n\n";
  std::vector<std::string> headers{"MEASURE", ">FIRST", ">SECOND", ">DIFFERENCE", "UNIT", ">PERCENT"};
  if (comparison.has_romberg) headers.emplace_back(">ROMBERG");
  cli::Table table(headers);
  for (const ComparedMeasure& compared : comparison.measures) {
    const auto& about = posturography::info(compared.measure);
    table.add({{std::string(about.symbol)},
               {significant(compared.first)},
               {significant(compared.second)},
               {significant(compared.second - compared.first, 4)},
               {about.unit == "1" ? "" : std::string(about.unit)},
               {compared.percent ? cli::decimal(*compared.percent, 1) : "-"},
               {compared.romberg ? cli::decimal(*compared.romberg, 2) : "-"}});
  }
  table.print(console);
  if (comparison.has_romberg) {
    console.out << "ROMBERG: eyes closed / eyes open, for each measure. A quotient below 1 is common and not an error.\n";
  }
}

}  // namespace dts::lab::sway
