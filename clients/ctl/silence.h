// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dts/error.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// Why nothing comes for the topic prefixes, and what to check, as far as the daemon's last status tells (nullptr: none
/// was heard). The code is Unreachable without a status, NotFound when nothing is published under any prefix,
/// DeviceGone when a rig's device does not stream, Timeout otherwise.
[[nodiscard]] client::Error explain_silence(const v1::StatusSnapshot* status, const std::vector<std::string>& prefixes,
                                            const std::string& endpoint);

/// Events of a rig that exists are asked for, and no stream: silence is what one expects.
[[nodiscard]] bool asks_for_events_only(const v1::StatusSnapshot* status, const std::vector<std::string>& prefixes);

}  // namespace dts::ctl
