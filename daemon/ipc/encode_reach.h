// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/reach.h"
#include "dts/v1/stream.pb.h"
#include "session/supervisor.h"

namespace dts::ipc {

[[nodiscard]] dts::v1::Event reach_event(std::uint64_t instance_id, const core::ReachEvent& event);
[[nodiscard]] dts::v1::Event class_event(std::uint64_t instance_id, const core::ClassEvent& event);
[[nodiscard]] dts::v1::TrialResult trial_result(const session::TrialResultNotice& notice);

}  // namespace dts::ipc
