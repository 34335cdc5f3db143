// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/measure_file.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lab/base/csv.h"
#include "lab/base/position_columns.h"
#include "record/catalogue/corrections.h"
#include "record/recording.h"
#include "session/recorded_sway.h"

namespace dts::lab::sway {
namespace {

using posturography::Analysis;
using posturography::AnalysisOptions;
using posturography::Measure;

constexpr double kSameDigits = 1e-9;  ///< Relative: rounding by other compilers and processors.

/// Returns false and adds a problem with its line if the times do not rise.
bool check_times(const std::string& file, const std::vector<double>& t_s, files::Problems& problems) {
  for (std::size_t row = 1; row < t_s.size(); ++row) {
    if (t_s[row] > t_s[row - 1]) continue;
    problems.push_back({file, static_cast<std::uint32_t>(CsvTable::line_of_row(row)), 1, "t_s does not increase"});
    return false;  // one report is enough: later rows have the same fault
  }
  return true;
}

std::optional<posturography::CopSeries> read_csv(const std::string& file, files::Problems& problems) {
  std::vector<CsvColumn> columns{{.name = "t_s", .minimum = -1e12, .maximum = 1e12},
                                 {.name = "load_n", .is_required = false, .may_be_empty = true, .minimum = -1e6, .maximum = 1e6}};
  add_position_columns(columns);
  const CsvTable table = CsvTable::read(file, columns, problems);
  if (!problems.empty() || !check_times(file, table.numbers("t_s"), problems)) return std::nullopt;
  const auto position = position_columns(file, table, problems);
  if (!position) return std::nullopt;
  auto series =
      posturography::even_series(table.numbers("t_s"), table.numbers(position->ml), table.numbers(position->ap), table.numbers("load_n"));
  if (series) return std::move(*series);
  problems.push_back({file, 0, 0, core::to_string(series.error())});
  return std::nullopt;
}

/// Fails as `force::read_standing_cop` and `posturography::even_series`.
core::Result<posturography::CopSeries> read_plates(const std::string& file, const force::CopChoice& choice) {
  DTS_TRY_ASSIGN(const auto cop, force::read_standing_cop(file, choice));
  return posturography::even_series(cop.t_s, cop.ml_mm, cop.ap_mm, cop.load_n);
}

/// Measures a file without trials: a CSV file, or one of force plates.
MeasuredFile measure_one(const SwayInput& input, const SwayArguments& arguments, const AnalysisOptions& options) {
  MeasuredFile measured;
  std::optional<posturography::CopSeries> series;
  if (force::has_plates(input.file, arguments.cop)) {
    auto read = read_plates(input.file, arguments.cop);
    if (!read) measured.error = read.error();
    if (read) series = std::move(*read);
  } else {
    series = read_csv(input.file, measured.problems);
  }
  if (!series) return measured;
  auto analysis = posturography::analyse(*series, options);
  if (!analysis) {
    measured.problems.push_back({input.file, 0, 0, core::to_string(analysis.error())});
    return measured;
  }
  MeasuredTrial trial{.file = input.file, .session = input.session, .subject = input.subject, .condition = input.condition};
  trial.labels = input.labels;
  trial.analysis = std::move(*analysis);
  measured.trials.push_back(std::move(trial));
  return measured;
}

/// The recording's facts about a trial have priority over those of the command line.
MeasuredTrial named(const session::StandingTrial& standing, const record::SessionFacts& facts, const SwayInput& input) {
  MeasuredTrial trial{.file = input.file, .session = input.session, .subject = input.subject};
  if (!facts.session_id.empty()) trial.session = facts.session_id;
  if (!facts.subject.empty()) trial.subject = facts.subject;
  trial.trial = standing.trial;
  trial.attempt = standing.attempt;
  trial.condition = standing.condition.empty() ? input.condition : standing.condition;
  trial.outcome = standing.outcome;
  trial.labels = standing.labels;
  for (const auto& label : input.labels) {
    if (trial.label(label.first).empty()) trial.labels.push_back(label);
  }
  return trial;
}

bool is_asked_for(const session::StandingTrial& trial, const SwayArguments& arguments) {
  if (!arguments.is_all && !trial.counts()) return false;
  return arguments.trials.empty() || std::ranges::find(arguments.trials, trial.trial) != arguments.trials.end();
}

bool is_report_definition(const AnalysisOptions& options) {
  const auto& report = posturography::kReportPreparation;
  return options.preparation.profile == report.profile && options.preparation.analysis_rate_hz == report.analysis_rate_hz &&
         options.preparation.trim_s == report.trim_s && !options.foot_length_mm;
}

std::optional<bool> compared(const MeasuredTrial& trial, const std::optional<session::SwayTrialResult>& live) {
  if (!live) return std::nullopt;
  if (trial.analysis.has_value() != live->analysis.has_value()) return false;
  return !trial.analysis || is_same(*trial.analysis, *live->analysis);
}

MeasuredFile measure_recording(const SwayInput& input, const SwayArguments& arguments, const AnalysisOptions& options,
                               const std::function<void(double)>& progress) {
  MeasuredFile measured;
  auto recording = record::Recording::open(input.file);
  if (!recording) {
    measured.error = recording.error();
    return measured;
  }
  const record::SessionFacts recorded = (*recording)->session().value_or(record::SessionFacts{});
  const auto corrections = record::corrections_beside(input.file, recorded);
  if (!corrections) {
    measured.error = corrections.error();
    return measured;
  }
  const record::SessionFacts facts = record::corrected(recorded, *corrections);
  auto standing = session::read_recorded_standing(**recording, [&](double part) { progress(0.5 * part); });
  if (!standing) {
    measured.error = standing.error();
    return measured;
  }
  measured.damage = (*recording)->damage();
  std::size_t done = 0;
  for (session::StandingTrial& one : standing->trials) {
    if (const std::string* outcome = corrections->outcome(record::leading_part(facts), one.trial, one.attempt)) one.outcome = *outcome;
    progress(0.5 + 0.5 * static_cast<double>(done++) / static_cast<double>(standing->trials.size()));
    if (!is_asked_for(one, arguments)) continue;
    MeasuredTrial trial = named(one, facts, input);
    if (one.trial == 0 && standing->trials.size() > 1) trial.stretch = static_cast<std::uint32_t>(done);
    trial.problem = one.problem;
    if (one.problem.empty()) {
      auto analysis = posturography::analyse(one.cop, options);
      if (analysis) {
        trial.analysis = std::move(*analysis);
      } else {
        trial.problem = core::to_string(analysis.error());
      }
    }
    if (is_report_definition(options)) trial.is_as_recorded = compared(trial, one.live);
    measured.trials.push_back(std::move(trial));
  }
  return measured;
}

}  // namespace

AnalysisOptions options_of(const SwayArguments& arguments, bool is_recording) {
  AnalysisOptions options;
  options.preparation.profile = posturography::profile_named(arguments.profile).value_or(posturography::Profile::Lp10);
  options.preparation.analysis_rate_hz =
      arguments.rate_hz.value_or(is_recording ? posturography::kReportPreparation.analysis_rate_hz : 0.0);
  options.preparation.trim_s = arguments.trim_s;
  options.foot_length_mm = arguments.foot_length_mm;
  return options;
}

MeasuredFile measure_file(const SwayInput& input, const SwayArguments& arguments, const std::function<void(double)>& progress) {
  const AnalysisOptions options = options_of(arguments, input.is_recording());
  return input.is_recording() ? measure_recording(input, arguments, options, progress) : measure_one(input, arguments, options);
}

bool is_same(const Analysis& a, const Analysis& b) {
  if (a.samples != b.samples || a.flags != b.flags || a.profile != b.profile) return false;
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const auto left = a.measures.get(static_cast<Measure>(k));
    const auto right = b.measures.get(static_cast<Measure>(k));
    if (left.has_value() != right.has_value()) return false;
    if (left && std::abs(*left - *right) > kSameDigits * std::max(std::abs(*left), std::abs(*right))) return false;
  }
  return true;
}

}  // namespace dts::lab::sway
