// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/clock.h"
#include "dts/v1/control.pb.h"
#include "session/supervisor.h"

namespace dts::ipc {

/// Whether a command with this answer is entered in the audit trail: every change, and what failed of the commands that the trail names.
[[nodiscard]] bool is_audited(const dts::v1::Request& request, const dts::v1::Response& response);

/// Enters a command with its answer: who, what, on what, how it ended. `sender` is "local" or "key:NAME". Texts that people typed (labels,
/// markers, fields) are not entered: nobody can erase the trail. Does nothing without recordings. Thread: control.
void enter_audit(session::Supervisor& supervisor, core::Clock& clock, const std::string& sender, const dts::v1::Request& request,
                 const dts::v1::Response& response);

}  // namespace dts::ipc
