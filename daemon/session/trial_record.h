// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result.h"
#include "record/event.h"
#include "session/trial_run.h"

namespace dts::session {

/// Writes the event "trial": phase, trial, attempt, block, condition, its labels and, if present, target_cm and rest_s.
[[nodiscard]] record::RecordedEvent to_record(const TrialEvent& event);
/// Reads the event "trial". Fails with DataDamaged, naming the key.
[[nodiscard]] core::Result<TrialEvent> trial_of(const record::RecordedEvent& event);

}  // namespace dts::session
