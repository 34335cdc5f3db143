// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/sway.h"
#include "dts/v1/stream.pb.h"
#include "session/sway_results.h"

namespace dts::ipc {

/// Returns preliminary values: only the measures that can be exact during a trial.
[[nodiscard]] dts::v1::Event sway_event(std::uint64_t instance_id, const core::SwayEvent& event);
/// Returns the final values of a trial.
[[nodiscard]] dts::v1::Sway sway(const session::SwayTrialResult& result, const std::string& session_id, const std::string& software);

}  // namespace dts::ipc
