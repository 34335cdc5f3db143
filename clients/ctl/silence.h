// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dts/error.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// Explains why no messages arrive for the topic prefixes, and what to check, based on the daemon's last status (nullptr: none arrived).
/// The code is Unreachable without a status, NotFound if nothing is published under any prefix, DeviceGone if a rig's device does not
/// stream, otherwise Timeout.
[[nodiscard]] client::Error explain_silence(const v1::StatusSnapshot* status, const std::vector<std::string>& prefixes,
                                            const std::string& endpoint);

/// Returns true if the prefixes match only events of an existing rig, and no stream: then silence is normal.
[[nodiscard]] bool asks_for_events_only(const v1::StatusSnapshot* status, const std::vector<std::string>& prefixes);

}  // namespace dts::ctl
