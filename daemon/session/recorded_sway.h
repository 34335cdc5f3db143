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

/// One trial of a recording with its centre of pressure. Of a recording without trials there is one, with trial 0, for each stretch in
/// which somebody stands for 10 s: without the second of stepping on, and the half second of stepping off.
struct StandingTrial {
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  std::uint32_t block = 1;
  std::string condition{};
  std::vector<std::pair<std::string, std::string>> labels{};
  std::string outcome{};  ///< "done", "redone", "rejected", "aborted"; of the newest step. Empty: no trial.
  std::uint32_t segment = 0;
  core::ScanIndex first_scan;
  core::ScanIndex end_scan;
  std::uint32_t end_segment = 0;  ///< Of `end_scan`: another than `segment` when gaps divide the trial.
  double begin_s = 0.0;           ///< Stream time of its first sample.
  posturography::CopSeries cop{};         ///< NaN where a gap is. Empty if there is a problem.
  std::string problem{};                  ///< Why the samples are not here: gaps make the trial too long.
  std::optional<SwayTrialResult> told{};  ///< What the daemon recorded for it.

  [[nodiscard]] bool counts() const noexcept { return outcome.empty() || outcome == "done"; }
};

/// What a recording says of quiet standing.
struct RecordedStanding {
  std::vector<StandingTrial> trials{};
  std::vector<SessionFigure> told_figures{};  ///< Events "figure".
  double raw_rate_hz = 0.0;                   ///< Of the scans that segments and trials count in.
};

/// Reads trials, their centre of pressure and what the daemon told of them. Fails as the reading does; NotFound: the recording has no
/// stream "cop"; DataDamaged: an event does not read; Unsupported: no trials, and longer than `kMostStandingSamples`. A trial that does not
/// fit into as many samples, those of the trials before and its gaps included, has a problem; the others are read.
inline constexpr std::size_t kMostStandingSamples = 20'000'000;
[[nodiscard]] core::Result<RecordedStanding> read_recorded_standing(record::Recording& recording,
                                                                    const std::function<void(double)>& progress);

}  // namespace dts::session
