// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "lab/compare/alignment.h"
#include "lab/compare/event_match.h"
#include "lab/compare/paired.h"
#include "lab/compare/pulse_train.h"

namespace dts::lab::compare {
namespace {

constexpr std::size_t kMostEvents = 500;

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

/// Few events cannot show a jump of a clock.
void warn_of_restarts(const Recording& a, const Recording& b, Alignment& alignment) {
  if ((a.restarts_s.empty() && b.restarts_s.empty()) || !alignment.pieces.empty() || !alignment.warning.empty()) return;
  alignment.warning = "a recording has gaps at which its clock may have jumped, and too few events to show it; record a pulse train";
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
  if (!alignment) return alignment;
  if (alignment->event_count > 0) alignment->means = means;
  warn_of_restarts(a, b, *alignment);
  return alignment;
}

Events marker_events(const Recording& a, const Recording& b) {
  auto [markers_a, markers_b] = common_markers(a, b);
  return {.a_s = std::move(markers_a), .b_s = std::move(markers_b), .sd_s = std::hypot(a.step_s(), b.step_s()) / std::sqrt(12.0)};
}

core::Result<Alignment> align_by_best_means(const Recording& a, const Recording& b) {
  if (have_pulse_trains(a, b)) return align_by_pulse_train(a, b);
  const Events triggers{.a_s = a.edges_s, .b_s = b.edges_s, .sd_s = std::hypot(a.edge_step_s, b.edge_step_s) / std::sqrt(12.0)};
  const bool are_too_many = std::max(a.edges_s.size(), b.edges_s.size()) > kMostEvents;
  if (!are_too_many && !triggers.a_s.empty() && !triggers.b_s.empty()) return align_events(a, b, triggers, Alignment::Means::Trigger);
  const Events markers = marker_events(a, b);
  auto alignment = markers.a_s.empty() ? align_by_correlation(a, b) : align_events(a, b, markers, Alignment::Means::Marker);
  if (alignment && are_too_many && alignment->warning.empty()) {
    alignment->warning = "a recording has more than " + std::to_string(kMostEvents) +
                         " triggers that are no pulse train: not used; check that the trigger is a digital level";
  }
  return alignment;
}

/// Events close together do not determine the drift over a long recording. Takes it from the signals if they know it better, else draws it
/// towards 0 by what is known of crystals.
void settle_drift(const Recording& a, const Recording& b, Alignment& alignment) {
  constexpr double kVagueDriftPpm = 20.0;
  constexpr double kCrystalPpm = 100.0;
  constexpr double kSureCorrelation = 0.7;
  const double sd_ppm = alignment.drift_sd_ppm;
  if (alignment.event_count == 0 || !alignment.pieces.empty() || !std::isfinite(sd_ppm) || sd_ppm < kVagueDriftPpm) return;
  const bool is_alike = correlation(pair_up(a, b, alignment)) > kSureCorrelation;  // otherwise, the signals may fit elsewhere by chance
  const auto by_signal = align_by_correlation(a, b);
  if (is_alike && by_signal && by_signal->pieces.empty() && by_signal->drift_sd_ppm < sd_ppm &&
      correlation(pair_up(a, b, *by_signal)) > kSureCorrelation) {
    alignment.drift_ppm = by_signal->drift_ppm;
    alignment.drift_sd_ppm = by_signal->drift_sd_ppm;
    alignment.is_drift_by_signals = true;
  } else if (sd_ppm > kCrystalPpm) {
    const double weight = kCrystalPpm * kCrystalPpm / (kCrystalPpm * kCrystalPpm + sd_ppm * sd_ppm);
    alignment.drift_ppm *= weight;
    alignment.drift_sd_ppm = std::sqrt(weight) * sd_ppm;
  }
}

}  // namespace

double Alignment::to_a_s(double t_b_s) const noexcept {
  const double drift = std::isfinite(drift_ppm) ? drift_ppm * 1e-6 : 0.0;
  const auto next = std::ranges::upper_bound(pieces, t_b_s, {}, &Piece::from_s);
  const double shift_s = next == pieces.begin() ? 0.0 : (next - 1)->shift_s;
  return t_b_s + offset_s + shift_s + drift * (t_b_s - reference_s);
}

double Alignment::sd_at_s(double t_b_s) const noexcept {
  const auto next = std::ranges::upper_bound(pieces, t_b_s, {}, &Piece::from_s);
  const bool is_whole = next == pieces.begin();
  const double sd_s = is_whole ? offset_sd_s : (next - 1)->sd_s;
  const double from_s = is_whole ? reference_s : (next - 1)->reference_s;
  return std::isfinite(drift_sd_ppm) ? std::hypot(sd_s, 1e-6 * drift_sd_ppm * (t_b_s - from_s)) : sd_s;
}

std::string_view name(Alignment::Means means) noexcept {
  switch (means) {
    case Alignment::Means::PulseTrain: return "pulse train";
    case Alignment::Means::Trigger: return "trigger";
    case Alignment::Means::Marker: return "marker";
    case Alignment::Means::Correlation: return "correlation";
  }
  return "correlation";
}

std::optional<Alignment> align_by_markers(const Recording& a, const Recording& b) {
  const Events markers = marker_events(a, b);
  if (markers.a_s.empty() || markers.a_s.size() > kMostEvents) return std::nullopt;
  const EventMatch match = match_events(markers);
  return is_certain(markers, match) ? std::optional(match.alignment) : std::nullopt;
}

core::Result<Alignment> align(const Recording& a, const Recording& b) {
  auto alignment = align_by_best_means(a, b);
  if (alignment) settle_drift(a, b, *alignment);
  return alignment;
}

}  // namespace dts::lab::compare
