// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "lab/compare/alignment.h"

namespace dts::lab::compare {

/// Largest possible drift between two clocks; crystals are accurate to 100 ppm.
inline constexpr double kLargestDrift = 300e-6;
/// With a larger uncertainty, the events are too close together to determine the drift.
inline constexpr double kVaguestDriftPpm = 1000.0;

/// Times of the rising events of both recordings. `sd_s` is the standard deviation of the difference between two times of one event, caused
/// by rounding to scans.
struct Events {
  std::vector<double> a_s;
  std::vector<double> b_s;
  double sd_s = 0.0;
};

/// Pairs of the same event on A's and on B's clock; no event is in two pairs.
using EventPairs = std::vector<std::pair<double, double>>;

struct EventMatch {
  Alignment alignment;        ///< A line through the pairs; `event_count` is 0 if there are none.
  bool is_ambiguous = false;  ///< Another offset matches about as many events.
};

/// Finds the offset that matches most events one to one; among equal offsets, the one with the smallest residuals. Cost: tries 50 events of
/// one recording with all events of the other.
[[nodiscard]] EventMatch match_events(const Events& events);

/// Pairs events that coincide if the clocks are aligned about as in `near`, within a few scans and `near_sd_s`.
[[nodiscard]] EventMatch match_events_near(const Events& events, const Alignment& near, double near_sd_s);

}  // namespace dts::lab::compare
