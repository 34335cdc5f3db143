// SPDX-License-Identifier: Apache-2.0
#include "accuracy/reach_scores.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "lab/base/csv.h"

namespace dts::accuracy {
namespace {

double median_of(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::vector<ReachTruth> read_truth(const std::string& folder) {
  std::vector<lab::CsvColumn> columns{{.name = "subject", .is_text = true}, {.name = "condition", .is_text = true}};
  const std::vector<std::string> numbers{"trial", "rate_hz", "trunk_deg", "t_p1", "t_p2", "t_p3", "p1_mm", "p2_mm", "p3_mm"};
  for (const std::string& name : numbers) columns.push_back({.name = name});
  files::Problems problems;
  const lab::CsvTable table = lab::CsvTable::read(folder + "/trials.csv", columns, problems);
  std::vector<ReachTruth> truth;
  if (!problems.empty()) return truth;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const auto of = [&](const char* name) { return table.numbers(name)[row]; };
    truth.push_back({.subject = table.texts("subject")[row],
                     .trial = of("trial"),
                     .rate_hz = of("rate_hz"),
                     .condition = table.texts("condition")[row],
                     .trunk_deg = of("trunk_deg"),
                     .t1_s = of("t_p1"),
                     .t2_s = of("t_p2"),
                     .t3_s = of("t_p3"),
                     .p1_mm = of("p1_mm"),
                     .p2_mm = of("p2_mm"),
                     .p3_mm = of("p3_mm")});
  }
  return truth;
}

ReachScores score(const std::vector<ReachTruth>& truth, const std::vector<std::optional<core::ReachEvent>>& reaches,
                  const std::vector<bool>& is_counted) {
  constexpr double kInTimeS = 0.1 + 1e-9;
  ReachScores scores;
  std::vector<double> d1_errors;
  std::vector<double> d2_errors;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    if (!is_counted[k]) continue;
    ++scores.trials;
    if (!reaches[k]) continue;
    ++scores.found;
    const ReachTruth& real = truth[k];
    const core::ReachEvent& reach = *reaches[k];
    const auto seconds = [&](core::ScanIndex scan) { return static_cast<double>(scan.value) / real.rate_hz; };
    scores.p1_in_time += std::abs(seconds(reach.p1.scan) - real.t1_s) <= kInTimeS ? 1.0 : 0.0;
    scores.p2_in_time += std::abs(seconds(reach.p2.scan) - real.t2_s) <= kInTimeS ? 1.0 : 0.0;
    scores.p3_in_time += std::abs(seconds(reach.p3.scan) - real.t3_s) <= kInTimeS ? 1.0 : 0.0;
    scores.p3_close += std::abs(reach.features.p3_mm - real.p3_mm) <= 0.05 * (real.p3_mm - real.p2_mm) ? 1.0 : 0.0;
    d1_errors.push_back(std::abs(reach.features.d1_mm() - (real.p1_mm - real.p2_mm)));
    const double d2_mm = real.p3_mm - real.p1_mm;
    d2_errors.push_back(std::abs(reach.features.d2_mm() - d2_mm));
    if (d2_errors.back() > 0.5 * std::abs(d2_mm)) ++scores.gross;
    if ((reach.flags & core::reach_flag::kMinor) != 0) ++scores.minor;
    scores.latest_s = std::max(scores.latest_s, seconds(reach.scan) - seconds(reach.p3.scan));
  }
  const auto found = static_cast<double>(std::max<std::size_t>(1, scores.found));
  for (double* part : {&scores.p1_in_time, &scores.p2_in_time, &scores.p3_in_time, &scores.p3_close}) *part /= found;
  scores.d1_median_error_mm = median_of(std::move(d1_errors));
  scores.d2_median_error_mm = median_of(std::move(d2_errors));
  return scores;
}

std::string table_head() {
  return "| trials | n | found | P1 in 0.1 s | P2 | P3 | P3 within 5 % | d1 error (mm) | d2 error (mm) | gross | minor | Final after P3 "
         "(s) |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
}

std::string table_row(const std::string& name, const ReachScores& scores) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "| " << name << " | " << scores.trials << " | " << scores.found << " | "
       << scores.p1_in_time << " | " << scores.p2_in_time << " | " << scores.p3_in_time << " | " << scores.p3_close << " | "
       << scores.d1_median_error_mm << " | " << scores.d2_median_error_mm << " | " << scores.gross << " | " << scores.minor << " | "
       << scores.latest_s << " |\n";
  return text.str();
}

}  // namespace dts::accuracy
