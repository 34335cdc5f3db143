// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "physics/body/person.h"
#include "record/recording.h"
#include "session/reach_results.h"

namespace dts::session {

/// One attempt of a trial of the reaching task in a recording.
struct RecordedReachTrial {
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  std::uint32_t block = 1;
  std::string condition{};
  std::optional<double> target_cm;
  std::string outcome{};  ///< "done", "redone", "rejected", "aborted": as in the catalogue.
  std::uint32_t segment = 0;
  core::ScanIndex go;                      ///< Scan of the cue.
  std::uint32_t end_segment = 0;           ///< Differs from `segment` if scans are missing between cue and end.
  core::ScanIndex end;                     ///< At least `go`.
  std::optional<ReachTrialResult> result;  ///< With all that is known at the end of the session; nothing for a trial that was never done.
  std::optional<core::TrunkMovement> first_movement;  ///< As decided when the trial was done, before the own scale was known.
  bool is_compared = false;                           ///< The daemon recorded a result for this trial ...
  bool differs = false;                               ///< ... and one of them differs from the result recomputed for that moment.
};

/// Results of the reaching trials of a recording: the daemon's own results, recomputed from the recorded events.
struct RecordedReaches {
  std::optional<physics::Person> person;     ///< From the fields of the session; empty: not all fields are present.
  std::uint64_t reaches = 0;                 ///< Final reaches that were not cancelled, inside or outside trials.
  std::vector<ReachTrialResult> trials;      ///< The valid ones, in the order of their cues.
  std::vector<RecordedReachTrial> attempts;  ///< All that had a cue and took place, in the order of their cues.
  std::vector<SessionFigure> summary;
  std::vector<SessionFigure> live_summary;              ///< As the daemon recorded it.
  std::optional<classifier::SubjectCalibration> scale;  ///< The subject's own.
  std::uint64_t live_results = 0;                       ///< Trial results that the daemon recorded.
  std::uint64_t differing = 0;                          ///< The number of these that differ from the results recomputed for that moment.
};

inline constexpr std::size_t kMostRecordedSteps = 1'000'000;

/// Reads the events "reach", "class", "trial", "result" and "figure". `model` (may be nullptr) classifies again with the subject's own
/// maximum reaches. Fails as reading fails, with DataDamaged if an event is not readable, and with Unsupported if there are more than
/// `kMostRecordedSteps`.
[[nodiscard]] core::Result<RecordedReaches> read_recorded_reaches(record::Recording& recording, const classifier::TrunkModel* model,
                                                                  const std::function<void(double)>& progress);

}  // namespace dts::session
