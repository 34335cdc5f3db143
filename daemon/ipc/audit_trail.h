// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/clock.h"
#include "dts/v1/control.pb.h"
#include "session/supervisor.h"

namespace dts::ipc {

/// Returns "local", or "local:anna" for a user of a gateway: both, because only the gateway vouches for the user's name. `sender` is
/// "local" or "key:NAME".
[[nodiscard]] std::string author_of(const std::string& sender, const dts::v1::Request& request);

/// Returns true if the audit trail records this command: the command has a name in the trail, and it is a change or it failed.
/// Not for an erasure that was done: `Recordings` enters that one itself, before it forgets what it erased.
[[nodiscard]] bool is_audited(const dts::v1::Request& request, const dts::v1::Response& response);

/// Records a command and its answer in the audit trail: sender, command, target, result. `sender` is "local" or "key:NAME". Does not record
/// texts that people typed (labels, markers, fields), because nobody can erase the trail. Does nothing without recordings. Thread: control.
void enter_audit(session::Supervisor& supervisor, core::Clock& clock, const std::string& sender, const dts::v1::Request& request,
                 const dts::v1::Response& response);

}  // namespace dts::ipc
