// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "lab/alignment.h"

namespace dts::lab {
namespace {

/// Two clocks differ by less: crystals are good to 100 ppm, timers of operating systems to 500.
constexpr double kLargestDrift = 1e-3;
constexpr std::size_t kMostEvents = 500;

using Pairs = std::vector<std::pair<double, double>>;  ///< Times on A's and B's clock.

/// Events that lie together when B is shifted so that one pair coincides.
Pairs pairs_for_shift(const std::vector<double>& a_s, const std::vector<double>& b_s, double shift_s, double at_b_s, double sd_s) {
  Pairs pairs;
  for (const double b : b_s) {
    const double wanted_s = b + shift_s;
    const double tolerance_s = 4.0 * sd_s + kLargestDrift * std::abs(b - at_b_s);
    const auto near = std::ranges::min_element(a_s, {}, [&](double a) { return std::abs(a - wanted_s); });
    if (near != a_s.end() && std::abs(*near - wanted_s) <= tolerance_s) pairs.emplace_back(*near, b);
  }
  return pairs;
}

double spread(const Pairs& pairs, double shift_s) {
  return std::accumulate(pairs.begin(), pairs.end(), 0.0,
                         [&](double sum, const auto& pair) { return sum + std::abs(pair.first - pair.second - shift_s); });
}

/// The pairs of the shift that most events agree on.
Pairs matched(const std::vector<double>& a_s, const std::vector<double>& b_s, double sd_s) {
  Pairs best;
  double best_spread = 0.0;
  for (const double a : a_s) {
    for (const double b : b_s) {
      Pairs pairs = pairs_for_shift(a_s, b_s, a - b, b, sd_s);
      const double pairs_spread = spread(pairs, a - b);
      if (pairs.size() < best.size() || (pairs.size() == best.size() && pairs_spread >= best_spread)) continue;
      best = std::move(pairs);
      best_spread = pairs_spread;
    }
  }
  return best;
}

double step_sd_s(const Recording& a, const Recording& b) { return std::hypot(a.step_s(), b.step_s()) / std::sqrt(12.0); }

/// Times of each marker text, in their order.
std::map<std::string, std::vector<double>> marker_times(const Recording& recording) {
  std::map<std::string, std::vector<double>> times;
  for (std::size_t row = 0; row < recording.marker.size(); ++row) {
    if (!recording.marker[row].empty()) times[recording.marker[row]].push_back(recording.t_s[row]);
  }
  return times;
}

/// Times of the texts that both have equally often.
std::pair<std::vector<double>, std::vector<double>> common_markers(const Recording& a, const Recording& b) {
  std::pair<std::vector<double>, std::vector<double>> common;
  const auto of_b = marker_times(b);
  for (const auto& [text, times] : marker_times(a)) {
    const auto same = of_b.find(text);
    if (same == of_b.end() || same->second.size() != times.size()) continue;
    common.first.insert(common.first.end(), times.begin(), times.end());
    common.second.insert(common.second.end(), same->second.begin(), same->second.end());
  }
  std::ranges::sort(common.first);
  std::ranges::sort(common.second);
  return common;
}

}  // namespace

double Alignment::to_a_s(double t_b_s) const noexcept {
  const double drift = std::isfinite(drift_ppm) ? drift_ppm * 1e-6 : 0.0;
  return t_b_s + offset_s + drift * (t_b_s - reference_s);
}

std::string_view name(Alignment::Means means) noexcept {
  switch (means) {
    case Alignment::Means::Trigger: return "trigger";
    case Alignment::Means::Marker: return "marker";
    case Alignment::Means::Correlation: return "correlation";
  }
  return "correlation";
}

std::vector<double> trigger_edges_s(const Recording& recording) {
  std::vector<double> edges;
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < recording.trigger.size(); ++row) {
    if (std::isfinite(recording.trigger[row])) rows.push_back(row);
  }
  if (rows.empty()) return edges;
  const auto [low, high] = std::ranges::minmax(rows, {}, [&](std::size_t row) { return recording.trigger[row]; });
  const double middle = (recording.trigger[low] + recording.trigger[high]) / 2.0;
  if (recording.trigger[low] == recording.trigger[high]) return edges;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    if (recording.trigger[rows[k - 1]] <= middle && recording.trigger[rows[k]] > middle) {
      edges.push_back((recording.t_s[rows[k - 1]] + recording.t_s[rows[k]]) / 2.0);
    }
  }
  return edges;
}

core::Result<Alignment> align_events(const std::vector<double>& a_s, const std::vector<double>& b_s, double sd_s) {
  if (a_s.size() > kMostEvents || b_s.size() > kMostEvents) {
    return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostEvents) + " events in one recording",
                      "is the trigger column a digital level?");
  }
  const Pairs pairs = matched(a_s, b_s, sd_s);
  if (pairs.empty()) return core::fail(core::ErrorCode::Failed, "the recordings have no event in common");
  const auto count = static_cast<double>(pairs.size());
  double mean_b_s = 0.0;
  double mean_difference_s = 0.0;
  for (const auto& [a, b] : pairs) {
    mean_b_s += b / count;
    mean_difference_s += (a - b) / count;
  }
  Alignment alignment{
      .offset_s = mean_difference_s, .offset_sd_s = sd_s / std::sqrt(count), .reference_s = mean_b_s, .event_count = pairs.size()};
  double squares = 0.0;
  double product = 0.0;
  for (const auto& [a, b] : pairs) {
    squares += (b - mean_b_s) * (b - mean_b_s);
    product += (b - mean_b_s) * (a - b - mean_difference_s);
  }
  if (pairs.size() > 1 && squares > 0.0) {
    alignment.drift_ppm = 1e6 * product / squares;
    alignment.drift_sd_ppm = 1e6 * sd_s / std::sqrt(squares);
  }
  return alignment;
}

core::Result<Alignment> align(const Recording& a, const Recording& b) {
  const auto edges_a = trigger_edges_s(a);
  const auto edges_b = trigger_edges_s(b);
  if (!edges_a.empty() && !edges_b.empty()) {
    auto alignment = align_events(edges_a, edges_b, step_sd_s(a, b));
    if (alignment) alignment->means = Alignment::Means::Trigger;
    return alignment;
  }
  const auto [markers_a, markers_b] = common_markers(a, b);
  if (!markers_a.empty()) {
    auto alignment = align_events(markers_a, markers_b, step_sd_s(a, b));
    if (alignment) alignment->means = Alignment::Means::Marker;
    return alignment;
  }
  return align_by_correlation(a, b);
}

}  // namespace dts::lab
