// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "device/device.h"
#include "dts/v1/stream.pb.h"
#include "session/figure.h"
#include "session/reach_results.h"
#include "session/session.h"
#include "session/sway_results.h"
#include "session/trial_run.h"

/// Events of a session: what the room `events` does for the pipeline. Replaces bytes that are not UTF-8. Thread: any.
namespace dts::session {

/// Return the event without its position.
[[nodiscard]] v1::Event marker_event(const std::string& text);
[[nodiscard]] v1::Event device_event(device::DeviceState state, const std::string& uri, const std::string& message);
[[nodiscard]] v1::Event to_event(const SessionView& view);
[[nodiscard]] v1::Event to_event(const TrialEvent& event, const std::string& session_id);
[[nodiscard]] v1::Event to_event(const ReachTrialResult& result, const std::string& session_id);
[[nodiscard]] v1::Event to_event(const SwayTrialResult& result, const std::string& session_id, const std::string& software);
[[nodiscard]] v1::Event to_event(const SessionFigure& result);
[[nodiscard]] v1::DeviceState to_message(device::DeviceState state);

/// Reads a step of a trial. Fails with DataDamaged, naming the field.
[[nodiscard]] core::Result<TrialEvent> trial_of(const v1::Event& event);
/// Reads the result of a trial of the reaching task; `has_gap` and the cue are not in the event. Fails with DataDamaged, naming the field.
[[nodiscard]] core::Result<ReachTrialResult> reach_result_of(const v1::Event& event);
/// Reads the final result of a trial of quiet standing. Fails with DataDamaged, naming the field.
[[nodiscard]] core::Result<SwayTrialResult> sway_of(const v1::Event& event);

}  // namespace dts::session
