// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "posturography/cop_series.h"
#include "record/recording.h"
#include "session/sway_results.h"

namespace dts::session {

/// One trial of a recording with its centre of pressure. A recording without trials has one entry, trial 0, for each period of at least 10
/// s in which a person stands on the plate, without the first 1 s (stepping on) and the last 0.5 s (stepping off).
struct StandingTrial {
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  std::uint32_t block = 1;
  std::string condition{};
  std::vector<std::pair<std::string, std::string>> labels{};
  std::string outcome{};  ///< "done", "redone", "rejected", "aborted"; from the newest event. Empty: the recording has no trials.
  std::uint32_t segment = 0;
  core::ScanIndex first_scan;
  core::ScanIndex end_scan;
  std::uint32_t end_segment = 0;          ///< Segment of `end_scan`: differs from `segment` if the trial has gaps.
  double begin_s = 0.0;                   ///< Stream time of the first sample.
  posturography::CopSeries cop{};         ///< NaN in gaps. Empty if there is a problem.
  std::string problem{};                  ///< Why there are no samples: with its gaps, the trial is too long.
  std::optional<SwayTrialResult> live{};  ///< The daemon's recorded result.

  [[nodiscard]] bool counts() const noexcept { return outcome.empty() || outcome == "done"; }
};

/// Trials of quiet standing in a recording.
struct RecordedStanding {
  std::vector<StandingTrial> trials{};
  std::vector<SessionFigure> live_results{};  ///< From the events "figure".
  double raw_rate_hz = 0.0;                   ///< Rate of the raw scans, which segments and trials use as index.
};

/// Reads the trials, their centre of pressure and the daemon's results. Fails like the reading of the file, and with NotFound if the
/// recording has no stream "cop", DataDamaged if an event cannot be parsed, Unsupported if a recording without trials is longer than
/// `kMostStandingSamples`. This limit also holds for all trials together, gaps included: a trial beyond it has a problem, the other trials
/// are read.
inline constexpr std::size_t kMostStandingSamples = 20'000'000;
[[nodiscard]] core::Result<RecordedStanding> read_recorded_standing(record::Recording& recording,
                                                                    const std::function<void(double)>& progress);

}  // namespace dts::session
