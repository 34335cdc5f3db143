// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "physics/body/person.h"
#include "record/recording.h"
#include "session/reach_results.h"

namespace dts::lab::results {

/// Results of the reaching trials of a recording: the daemon's own results, recomputed from the recorded events.
struct RecordedReaches {
  std::optional<physics::Person> person;  ///< From the fields of the session; empty: not all fields are present.
  std::uint64_t reaches = 0;              ///< Final reaches that were not cancelled, inside or outside trials.
  std::vector<session::ReachTrialResult> trials;
  std::vector<session::SessionFigure> summary;
  std::uint64_t live_results = 0;  ///< Trial results that the daemon recorded.
  std::uint64_t differing = 0;     ///< The number of these that differ from the results recomputed for that moment.
};

inline constexpr std::size_t kMostRecordedSteps = 1'000'000;

/// Reads the events "reach", "class", "trial" and "result". `model` (may be nullptr) classifies again with the subject's own maximum
/// reaches. Fails as reading fails, with DataDamaged if an event is not readable, and with Unsupported if there are more than
/// `kMostRecordedSteps`.
[[nodiscard]] core::Result<RecordedReaches> read_recorded_reaches(record::Recording& recording, const classifier::TrunkModel* model,
                                                                  const std::function<void(double)>& progress);

}  // namespace dts::lab::results
