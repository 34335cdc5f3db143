// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/event.h"
#include "core/frame.h"
#include "dts/v1/stream.pb.h"
#include "posturography/analysis.h"

/// Makes events from what the pipeline computed. Leaves instance_id empty. Thread: any.
namespace dts::events {

/// Returns the event for the gap before scan 0 of the frame's segment.
[[nodiscard]] v1::Event make_gap(const core::Frame& frame);
/// `trigger_channel`: name of the channel on which the rig detects triggers; may be empty.
[[nodiscard]] v1::Event make(const core::Event& event, const std::string& trigger_channel);

[[nodiscard]] v1::Gap to_message(const core::Gap& gap);
[[nodiscard]] v1::Reach to_message(const core::ReachEvent& event);
/// `number`: of the reach.
[[nodiscard]] v1::TrunkMovement to_message(const core::TrunkMovement& movement, std::uint32_t number);
/// Adds the results of a trial of quiet standing.
void add(const posturography::Analysis& analysis, v1::Sway& out);

}  // namespace dts::events
