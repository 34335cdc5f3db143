// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "lab/alignment.h"

namespace dts::lab {

/// Two clocks are taken to differ by less: crystals are good to 100 ppm.
inline constexpr double kLargestDrift = 300e-6;

/// Rising times of the events of both recordings, and the standard deviation of the difference of two times of one event (s), to
/// which scans round them.
struct Events {
  std::vector<double> a_s;
  std::vector<double> b_s;
  double sd_s = 0.0;
};

/// The same events on A's and on B's clock; none twice.
using EventPairs = std::vector<std::pair<double, double>>;

struct EventMatch {
  Alignment alignment;        ///< A line through the pairs; `event_count` is 0 when there are none.
  bool is_ambiguous = false;  ///< Another offset brings together about as many.
};

/// The offset that brings together most events, one to one; among those the one with the smallest residuals. Time: 50 events of one
/// recording with all of the other are tried.
[[nodiscard]] EventMatch match_events(const Events& events);

/// The events that lie together when the clocks are about as `near` says, within a few scans and `near_sd_s`.
[[nodiscard]] EventMatch match_events_near(const Events& events, const Alignment& near, double near_sd_s);

}  // namespace dts::lab
