// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result.h"
#include "record/event.h"
#include "session/trial_run.h"

namespace dts::session {

/// Event "trial": phase, trial, attempt, block, condition, its labels and, where there are any, target_cm, rest_s.
[[nodiscard]] record::RecordedEvent to_record(const TrialEvent& event);
/// Fails with DataDamaged, naming the key.
[[nodiscard]] core::Result<TrialEvent> trial_of(const record::RecordedEvent& event);

}  // namespace dts::session
