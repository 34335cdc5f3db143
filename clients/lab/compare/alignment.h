// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "lab/compare/recording.h"

namespace dts::lab::compare {

/// Maps B's clock to A's clock: t_a = t_b + offset + drift (t_b - reference).
struct Alignment {
  enum class Means { Trigger, Marker, Correlation };

  Means means = Means::Correlation;
  double offset_s = 0.0;                                        ///< At `reference_s`.
  double offset_sd_s = 0.0;                                     ///< Standard deviation.
  double drift_ppm = std::numeric_limits<double>::quiet_NaN();  ///< NaN: unknown with a single event; counts as 0.
  double drift_sd_ppm = std::numeric_limits<double>::quiet_NaN();
  double reference_s = 0.0;                                            ///< On B's clock, in the middle of the used data.
  std::size_t event_count = 0;                                         ///< Common triggers or markers.
  double peak_correlation = std::numeric_limits<double>::quiet_NaN();  ///< Correlation only.
  std::string warning;                                                 ///< Why existing events were not used; empty: no warning.

  [[nodiscard]] double to_a_s(double t_b_s) const noexcept;
};

/// "trigger", "marker", "correlation"
[[nodiscard]] std::string_view name(Alignment::Means means) noexcept;

/// Below this value, similarity may be chance: any two recordings have some similar part.
inline constexpr double kLeastCorrelation = 0.3;

/// Aligns by trigger edges that both recordings have, else by equal markers, else by cross-correlation of both axes, refined by least
/// squares in offset, drift, and gain and mean per axis. A single pair of events, two pairs of three or more, and events that match in
/// several ways are accepted only if the signals are similar. Otherwise, and if less than half of the events match, uses the signals and
/// sets a warning. Fails with Failed if nothing matches, and with LimitExceeded for more than 500 events.
[[nodiscard]] core::Result<Alignment> align(const Recording& a, const Recording& b);

// The parts of `align`.

/// Returns the times at which the trigger rises through the middle of its range; half a step early, because it rose between two scans.
[[nodiscard]] std::vector<double> trigger_edges_s(const Recording& recording);
[[nodiscard]] core::Result<Alignment> align_by_correlation(const Recording& a, const Recording& b);

}  // namespace dts::lab::compare
