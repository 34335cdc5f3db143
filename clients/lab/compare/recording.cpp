// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/recording.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lab/base/csv.h"
#include "lab/base/position_columns.h"

namespace dts::lab::compare {
namespace {

constexpr std::size_t kFewestScans = 20;
constexpr double kShortestS = 2.0;
constexpr double kGapSteps = 3.5;      ///< Two missing samples are interpolated; three are a gap.
constexpr double kOffGridSteps = 0.1;  ///< After a gap, times further off the grid of the times before are those of a restarted clock.

/// The low and the high level of a digital signal.
struct Levels {
  double low = 0.0;
  double high = 0.0;
};

/// Returns the levels without the rarest values, which may be spikes; but pulses may be rare too, and must not be lost.
Levels levels_of(std::span<const double> values, const std::vector<std::size_t>& rows) {
  constexpr double kLeastPart = 0.25;  // of the whole range: less between two quantiles is noise, and the pulses are rarer
  std::vector<double> sorted;
  for (const std::size_t row : rows) sorted.push_back(values[row]);
  if (sorted.empty()) return {};
  std::ranges::sort(sorted);
  const auto all = static_cast<double>(sorted.size() - 1);
  for (const double part : {0.01, 0.001}) {
    const Levels levels{.low = sorted[static_cast<std::size_t>(std::floor(part * all))],
                        .high = sorted[static_cast<std::size_t>(std::ceil((1.0 - part) * all))]};
    if (levels.high - levels.low >= kLeastPart * (sorted.back() - sorted.front())) return levels;
  }
  return {.low = sorted.front(), .high = sorted.back()};
}

/// Returns whether most values are near one of the levels, as those of a digital signal are.
bool are_two_levels(std::span<const double> values, const std::vector<std::size_t>& rows, const Levels& levels) {
  constexpr double kLeastRange = 0.05;  // V, or of a signal that is 0 or 1
  const double range = levels.high - levels.low;
  if (!(range >= kLeastRange)) return false;
  const auto between = std::ranges::count_if(rows, [&](std::size_t row) {
    const double part = (values[row] - levels.low) / range;
    return part > 0.25 && part < 0.75;
  });
  return 2 * static_cast<std::size_t>(between) < rows.size();
}

double median_step(std::span<const double> t_s) {
  if (t_s.size() < 2) return 0.0;
  std::vector<double> steps;
  for (std::size_t k = 1; k < t_s.size(); ++k) steps.push_back(t_s[k] - t_s[k - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return *middle;
}

void check_times(const std::string& file, bool is_xdf, const Recording& recording, files::Problems& problems) {
  const auto& t_s = recording.t_s;
  for (std::size_t row = 1; row < t_s.size(); ++row) {
    if (t_s[row] > t_s[row - 1]) continue;
    problems.push_back({file, is_xdf ? 0U : static_cast<std::uint32_t>(CsvTable::line_of_row(row)), 1, "t_s does not increase"});
    return;  // one report is enough: later rows have the same fault
  }
  if (t_s.size() >= kFewestScans && t_s.back() - t_s.front() >= kShortestS) return;
  problems.push_back({file, 0, 0, "too short: a recording needs at least " + std::to_string(kFewestScans) + " scans over 2 s"});
}

/// The time between scans, where no scan is missing.
struct Grid {
  double step_s = 0.0;      ///< Mean: rounded times have no exact step.
  double rounding_s = 0.0;  ///< Range of most steps.
  double count = 0.0;
  double stretches = 1.0;  ///< Between gaps. The rounding at their ends is in the mean.
};

Grid grid_of(std::span<const double> t_s) {
  constexpr double kLongestStep = 1.5;
  const double median_s = median_step(t_s);
  Grid grid;
  std::vector<double> steps;
  for (std::size_t k = 1; k < t_s.size(); ++k) {
    const double step_s = t_s[k] - t_s[k - 1];
    step_s < kLongestStep* median_s ? steps.push_back(step_s) : void(grid.stretches += 1.0);
  }
  if (steps.empty()) return grid;
  std::ranges::sort(steps);
  grid.count = static_cast<double>(steps.size());
  for (const double step_s : steps) grid.step_s += step_s / grid.count;
  grid.rounding_s = steps[steps.size() - 1 - steps.size() / 20] - steps[steps.size() / 20];
  return grid;
}

/// A CSV file does not name its segments: after a gap, a clock that did not restart stays on its grid. The error of the grid grows with the
/// length of the gap.
std::vector<double> restarts_of(std::span<const double> t_s) {
  std::vector<double> restarts;
  const Grid grid = grid_of(t_s);
  for (std::size_t k = 1; k < t_s.size(); ++k) {
    const double steps = (t_s[k] - t_s[k - 1]) / grid.step_s;
    const double rounding = grid.rounding_s / grid.step_s;
    const double tolerance = kOffGridSteps + rounding + rounding * steps * grid.stretches / grid.count;
    if (steps > kGapSteps && std::abs(steps - std::round(steps)) > tolerance) restarts.push_back(t_s[k]);
  }
  return restarts;
}

Recording read_csv_recording(const std::string& file, files::Problems& problems) {
  std::vector<CsvColumn> columns{{.name = "t_s", .minimum = -1e12, .maximum = 1e12},
                                 {.name = "trigger", .is_required = false, .may_be_empty = true},
                                 {.name = "marker", .is_required = false, .is_text = true}};
  add_position_columns(columns);
  const std::size_t before = problems.size();
  const CsvTable table = CsvTable::read(file, columns, problems);
  const auto position = problems.size() == before ? position_columns(file, table, problems) : std::nullopt;
  if (!position) return {};
  Recording recording{.t_s = table.numbers("t_s"),
                      .x_mm = table.numbers(position->ml),
                      .y_mm = table.numbers(position->ap),
                      .marker = table.texts("marker")};
  RisingEdges edges = rising_edges(recording.t_s, table.numbers("trigger"));
  recording.edges_s = std::move(edges.at_s);
  recording.edge_step_s = edges.step_s;
  recording.restarts_s = restarts_of(recording.t_s);
  return recording;
}

Recording read_plates(const std::string& file, const force::CopChoice& choice, files::Problems& problems) {
  auto cop = force::read_standing_cop(file, choice);
  if (!cop) {
    const std::string text = core::to_string(cop.error());
    problems.push_back({.file = file, .text = text.starts_with(file + ": ") ? text.substr(file.size() + 2) : text});
    return {};
  }
  Recording recording{.t_s = std::move(cop->t_s), .x_mm = std::move(cop->ml_mm), .y_mm = std::move(cop->ap_mm)};
  return recording;
}

}  // namespace

Recording read_recording(const std::string& file, const force::CopChoice& choice, files::Problems& problems) {
  const std::size_t before = problems.size();
  const bool is_xdf = file.ends_with(".xdf") || file.ends_with(".xdf.part");
  if (is_xdf) {
    Recording recording = read_xdf_recording(file, problems);
    if (problems.size() == before) check_times(file, true, recording, problems);
    return recording;
  }
  Recording recording = force::has_plates(file, choice) ? read_plates(file, choice, problems) : read_csv_recording(file, problems);
  if (!recording.t_s.empty()) recording.began_s = recording.t_s.front();
  for (auto* times_s : {&recording.t_s, &recording.edges_s, &recording.restarts_s}) {
    for (double& t_s : *times_s) t_s -= recording.began_s;
  }
  if (problems.size() == before) check_times(file, false, recording, problems);
  return recording;
}

double Recording::step_s() const { return median_step(t_s); }

RisingEdges rising_edges(std::span<const double> t_s, std::span<const double> values, std::optional<TriggerLevel> trigger) {
  constexpr double kFar = 0.1;  // of the range: a scan this near to the low or high level is not within the edge
  constexpr double kSoftStep = 0.1;
  RisingEdges edges;
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (std::isfinite(values[row])) rows.push_back(row);
  }
  const Levels levels = levels_of(values, rows);
  const double range = levels.high - levels.low;
  if (!trigger && !are_two_levels(values, rows, levels)) return edges;
  if (rows.empty()) return edges;
  const double step_s = median_step(t_s);
  const double level = trigger ? trigger->level : levels.low + range / 2.0;
  const double armed_below = level - (trigger ? trigger->band / 2.0 : range / 4.0);
  const double complete_above = level + (trigger ? trigger->band / 2.0 : 0.0);
  bool is_armed = values[rows.front()] < armed_below;
  std::size_t soft = 0;
  double crossed_s = 0.0;
  bool is_soft = false;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const double before = values[rows[k - 1]];
    const double now = values[rows[k]];
    const double from_s = t_s[rows[k - 1]];
    const double to_s = t_s[rows[k]];
    if (to_s - from_s > kGapSteps * step_s) is_armed = false;
    if (is_armed && before <= level && now > level) {
      crossed_s = from_s + (level - before) / (now - before) * (to_s - from_s);
      is_soft = before > levels.low + kFar * range || now < levels.high - kFar * range;
    }
    if (is_armed && now > complete_above) {
      is_armed = false;
      edges.at_s.push_back(crossed_s);
      soft += is_soft ? 1 : 0;
    }
    is_armed = is_armed || now < armed_below;
  }
  const bool are_soft = 2 * soft > edges.at_s.size();
  edges.step_s = (are_soft ? kSoftStep : 1.0) * step_s;
  return edges;
}

SmoothSeries::SmoothSeries(std::span<const double> t_s, std::span<const double> values) {
  for (std::size_t k = 0; k < t_s.size(); ++k) {
    const bool is_later = t_s_.empty() ? std::isfinite(t_s[k]) : t_s[k] > t_s_.back();
    if (!std::isfinite(values[k]) || !is_later) continue;
    t_s_.push_back(t_s[k]);
    values_.push_back(values[k]);
  }
  longest_step_s_ = kGapSteps * median_step(t_s);
  for (std::size_t k = 0; k < t_s_.size(); ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1;
    const std::size_t after = std::min(k + 1, t_s_.size() - 1);
    slopes_.push_back(after == before ? 0.0 : (values_[after] - values_[before]) / (t_s_[after] - t_s_[before]));
  }
}

SmoothSeries::Value SmoothSeries::at(double t_s) const {
  constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();
  const auto next = std::ranges::upper_bound(t_s_, t_s);
  if (next == t_s_.begin() || next == t_s_.end()) {
    const bool is_last = !t_s_.empty() && t_s == t_s_.back();
    return is_last ? Value{values_.back(), slopes_.back()} : Value{kUndefined, kUndefined};
  }
  const auto k = static_cast<std::size_t>(next - t_s_.begin()) - 1;
  const double step_s = t_s_[k + 1] - t_s_[k];
  if (step_s > longest_step_s_) return {kUndefined, kUndefined};
  const double u = (t_s - t_s_[k]) / step_s;
  const double rise = values_[k + 1] - values_[k];
  // value = v0 + u (m0 + u (c2 + u c3)) with the slopes m0, m1 in units per step
  const double m0 = slopes_[k] * step_s;
  const double m1 = slopes_[k + 1] * step_s;
  const double c2 = 3.0 * rise - 2.0 * m0 - m1;
  const double c3 = m0 + m1 - 2.0 * rise;
  return {values_[k] + u * (m0 + u * (c2 + u * c3)), (m0 + u * (2.0 * c2 + 3.0 * u * c3)) / step_s};
}

}  // namespace dts::lab::compare
