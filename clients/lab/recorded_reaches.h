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

namespace dts::lab {

/// What the events of a recording say came of its reaching trials: the daemon's own results, computed again from what it told.
struct RecordedReaches {
  std::optional<physics::Person> person;  ///< By the fields of the session; nothing: not all were given.
  std::uint64_t reaches = 0;              ///< That became final and were not cancelled, in trials or not.
  std::vector<session::ReachTrialResult> trials;
  std::vector<session::SessionFigure> summary;
  std::uint64_t told = 0;       ///< Results of trials that the daemon recorded when it told them,
  std::uint64_t differing = 0;  ///< and how many of them are not what is computed here for that moment.
};

inline constexpr std::size_t kMostRecordedSteps = 1'000'000;

/// Reads the events "reach", "class", "trial" and "result". `model` (nullptr: none) judges again by the subject's own maximum reaches.
/// Fails as the reading does, with DataDamaged when an event does not read, and with Unsupported when there are more than
/// `kMostRecordedSteps`.
[[nodiscard]] core::Result<RecordedReaches> read_recorded_reaches(record::Recording& recording, const classifier::TrunkModel* model,
                                                                  const std::function<void(double)>& progress);

}  // namespace dts::lab
