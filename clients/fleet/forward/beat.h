// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "dts/v1/control.pb.h"
#include "dts/v1/fleet.pb.h"

namespace dts::fleet::forward {

/// Returns what is sent to the centre every 10 s. `status`: dtsd's newest; nullptr: dtsd does not answer. It holds no text that a person
/// typed.
[[nodiscard]] v1::Beat beat_of(const v1::StatusSnapshot* status, const v1::Backlog& backlog, const std::string& version,
                               std::int64_t utc_ns);

/// Returns true if a rig has a session.
[[nodiscard]] bool is_session_running(const v1::StatusSnapshot& status);

}  // namespace dts::fleet::forward
