// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "lab/compare/alignment.h"
#include "lab/compare/event_match.h"
#include "lab/compare/paired.h"

namespace dts::lab::compare {
namespace {

constexpr std::size_t kMostEvents = 500;

double step_sd_s(const Recording& a, const Recording& b) { return std::hypot(a.step_s(), b.step_s()) / std::sqrt(12.0); }

/// Returns the times of each marker text, in order.
std::map<std::string, std::vector<double>> marker_times(const Recording& recording) {
  std::map<std::string, std::vector<double>> times;
  for (std::size_t row = 0; row < recording.marker.size(); ++row) {
    if (!recording.marker[row].empty()) times[recording.marker[row]].push_back(recording.t_s[row]);
  }
  return times;
}

/// Returns the times of the texts that both recordings contain equally often.
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

/// Returns whether `count` is at least half of the events of the recording with fewer events.
bool is_half(const Events& events, std::size_t count) { return 2 * count >= std::min(events.a_s.size(), events.b_s.size()); }

/// Returns whether the match cannot be chance: three pairs do not match by chance, nor do two if there is no third event; one pair always
/// matches.
bool is_certain(const Events& events, const EventMatch& match) {
  const std::size_t count = match.alignment.event_count;
  if (match.is_ambiguous || count < 2 || !is_half(events, count)) return false;
  return count > 2 || std::min(events.a_s.size(), events.b_s.size()) == 2;
}

bool looks_alike(const Recording& a, const Recording& b, const Alignment& alignment) {
  return correlation(pair_up(a, b, alignment)) > kLeastCorrelation;
}

std::string why_not(const Events& events, const EventMatch& match, Alignment::Means means) {
  const std::size_t count = match.alignment.event_count;
  const std::string fitting = std::to_string(count) + " of " + std::to_string(events.a_s.size()) + " and " +
                              std::to_string(events.b_s.size()) + " " + std::string(name(means)) + " events " +
                              (count == 1 ? "matches" : "match");
  if (!is_half(events, count)) return "only " + fitting;
  return fitting + (match.is_ambiguous ? " in more than one way" : ", but the recordings differ at these times");
}

/// If the events leave doubt, the signals decide; events that agree with the signals refine the alignment.
core::Result<Alignment> align_doubtful(const Recording& a, const Recording& b, const Events& events, const std::string& doubt) {
  auto by_signal = align_by_correlation(a, b);
  if (!by_signal) {
    core::Error error = by_signal.error();
    error.what = doubt + ", and " + error.what;
    return tl::make_unexpected(error);
  }
  const EventMatch near = match_events_near(events, *by_signal, 4.0 * by_signal->offset_sd_s);
  const bool is_confirmed = near.alignment.event_count > 0 && is_half(events, near.alignment.event_count);
  if (is_confirmed && looks_alike(a, b, near.alignment)) return near.alignment;
  by_signal->warning = doubt + ": aligned by correlation instead";
  return by_signal;
}

core::Result<Alignment> align_events(const Recording& a, const Recording& b, const Events& events, Alignment::Means means) {
  if (std::max(events.a_s.size(), events.b_s.size()) > kMostEvents) {
    return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostEvents) + " events in one recording",
                      "check that the trigger column is a digital level");
  }
  const EventMatch match = match_events(events);
  core::Result<Alignment> alignment = match.alignment;
  const bool may_be = is_half(events, match.alignment.event_count) && !match.is_ambiguous;
  if (!is_certain(events, match) && !(may_be && looks_alike(a, b, match.alignment))) {
    alignment = align_doubtful(a, b, events, why_not(events, match, means));
  }
  if (alignment && alignment->event_count > 0) alignment->means = means;
  return alignment;
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

core::Result<Alignment> align(const Recording& a, const Recording& b) {
  const double sd_s = step_sd_s(a, b);
  Events triggers{.a_s = trigger_edges_s(a), .b_s = trigger_edges_s(b), .sd_s = sd_s};
  if (!triggers.a_s.empty() && !triggers.b_s.empty()) return align_events(a, b, triggers, Alignment::Means::Trigger);
  auto [markers_a, markers_b] = common_markers(a, b);
  const Events markers{.a_s = std::move(markers_a), .b_s = std::move(markers_b), .sd_s = sd_s};
  if (!markers.a_s.empty()) return align_events(a, b, markers, Alignment::Means::Marker);
  return align_by_correlation(a, b);
}

}  // namespace dts::lab::compare
