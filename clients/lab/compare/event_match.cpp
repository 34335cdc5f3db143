// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/event_match.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dts::lab::compare {
namespace {

constexpr double kToleranceSd = 6.0;  ///< About two scans of equal recordings; rounding causes at most one.
constexpr std::size_t kMostAnchors = 50;
constexpr double kAlmostAsMany = 0.8;

/// Largest distance of an event from its expected time.
struct Tolerance {
  double fixed_s = 0.0;
  double drift = 0.0;    ///< Added: this factor times the distance...
  double about_s = 0.0;  ///< ...from this time, on B's clock.

  [[nodiscard]] double at(double b_s) const { return fixed_s + drift * std::abs(b_s - about_s); }
};

EventPairs pairs_along(const Events& events, const Alignment& clocks, const Tolerance& tolerance) {
  EventPairs pairs;
  const auto& [a_s, b_s, sd_s] = events;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a_s.size() && j < b_s.size()) {
    const double late_s = a_s[i] - clocks.to_a_s(b_s[j]);
    const double distance_s = std::abs(late_s);
    if (distance_s > tolerance.at(b_s[j])) {
      late_s < 0.0 ? ++i : ++j;
    } else if (i + 1 < a_s.size() && std::abs(a_s[i + 1] - clocks.to_a_s(b_s[j])) < distance_s) {
      ++i;
    } else if (j + 1 < b_s.size() && std::abs(a_s[i] - clocks.to_a_s(b_s[j + 1])) < distance_s) {
      ++j;
    } else {
      pairs.emplace_back(a_s[i++], b_s[j++]);
    }
  }
  return pairs;
}

struct Fit {
  Alignment alignment;
  double residual_s2 = 0.0;  ///< Mean square. With two pairs, from a fit without drift, because a fit with drift has no residuals.
};

/// Least squares in offset and drift. The standard deviations are those of the residuals, but at least the rounding to scans.
Fit fit_line(const EventPairs& pairs, double sd_s) {
  const auto count = static_cast<double>(pairs.size());
  double mean_b_s = 0.0;
  double mean_late_s = 0.0;
  for (const auto& [a, b] : pairs) {
    mean_b_s += b / count;
    mean_late_s += (a - b) / count;
  }
  double spread = 0.0;
  double product = 0.0;
  double squares = 0.0;
  for (const auto& [a, b] : pairs) {
    const double late_s = a - b - mean_late_s;
    spread += (b - mean_b_s) * (b - mean_b_s);
    product += (b - mean_b_s) * late_s;
    squares += late_s * late_s;
  }
  Fit fit{.alignment = {.offset_s = mean_late_s, .reference_s = mean_b_s, .event_count = pairs.size()}, .residual_s2 = squares / count};
  double event_sd_s = sd_s;
  if (pairs.size() > 2 && spread > 0.0) {
    const double left = std::max(0.0, squares - product * product / spread);
    fit.residual_s2 = left / count;
    event_sd_s = std::max(sd_s, std::sqrt(left / (count - 2.0)));
  }
  fit.alignment.offset_sd_s = event_sd_s / std::sqrt(count);
  if (pairs.size() < 2 || spread <= 0.0) return fit;
  const double drift_sd_ppm = 1e6 * event_sd_s / std::sqrt(spread);
  if (drift_sd_ppm > kVaguestDriftPpm) return fit;
  fit.alignment.drift_ppm = 1e6 * product / spread;
  fit.alignment.drift_sd_ppm = drift_sd_ppm;
  return fit;
}

/// Returns at most kMostAnchors of the times, evenly spread.
std::vector<double> anchors_of(const std::vector<double>& times_s) {
  std::vector<double> anchors;
  const std::size_t count = std::min(times_s.size(), kMostAnchors);
  for (std::size_t k = 0; k < count; ++k) anchors.push_back(times_s[k * times_s.size() / count]);
  return anchors;
}

/// A pair of events that may be the same event, and the number of others that agree.
struct Candidate {
  double a_s;
  double b_s;
  std::size_t count;
};

Tolerance tolerance_about(double b_s, double sd_s) { return {.fixed_s = kToleranceSd * sd_s, .drift = kLargestDrift, .about_s = b_s}; }

/// Matches again along the found line, where no tolerance for drift is needed.
Alignment refined(const Events& events, const Alignment& rough) {
  const EventPairs pairs = pairs_along(events, rough, {.fixed_s = kToleranceSd * events.sd_s});
  return pairs.empty() ? rough : fit_line(pairs, events.sd_s).alignment;
}

}  // namespace

EventMatch match_events(const Events& events) {
  const bool is_a_smaller = events.a_s.size() < events.b_s.size();
  const auto some_a_s = is_a_smaller ? anchors_of(events.a_s) : events.a_s;
  const auto some_b_s = is_a_smaller ? events.b_s : anchors_of(events.b_s);
  std::vector<Candidate> candidates;
  Fit best;
  for (const double a : some_a_s) {
    for (const double b : some_b_s) {
      const EventPairs pairs = pairs_along(events, {.offset_s = a - b, .reference_s = b}, tolerance_about(b, events.sd_s));
      if (pairs.empty()) continue;
      candidates.push_back({a, b, pairs.size()});
      if (pairs.size() < best.alignment.event_count) continue;
      const Fit fit = fit_line(pairs, events.sd_s);
      if (pairs.size() == best.alignment.event_count && fit.residual_s2 >= best.residual_s2) continue;
      best = fit;
    }
  }
  if (candidates.empty()) return {};
  EventMatch match{.alignment = refined(events, best.alignment)};
  const double many = kAlmostAsMany * static_cast<double>(best.alignment.event_count);
  const Tolerance same = tolerance_about(match.alignment.reference_s, events.sd_s);
  match.is_ambiguous = std::ranges::any_of(candidates, [&](const Candidate& other) {
    return static_cast<double>(other.count) >= many && std::abs(other.a_s - match.alignment.to_a_s(other.b_s)) > same.at(other.b_s);
  });
  return match;
}

EventMatch match_events_near(const Events& events, const Alignment& near, double near_sd_s) {
  const EventPairs pairs = pairs_along(events, near, {.fixed_s = kToleranceSd * events.sd_s + near_sd_s});
  if (pairs.empty()) return {};
  return {.alignment = refined(events, fit_line(pairs, events.sd_s).alignment)};
}

}  // namespace dts::lab::compare
