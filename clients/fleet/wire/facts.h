// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>

#include "dts/v1/fleet.pb.h"
#include "dts/v1/sessions.pb.h"

namespace dts::fleet::wire {

/// What the clinic allows to leave besides measurements, subject IDs and states.
struct SendRules {
  bool labels = false;             ///< Labels and notes of sessions, texts of markers.
  std::set<std::string> fields{};  ///< Names of the protocol's fields: "arm_length_cm".
};

/// Returns the facts of a session that may leave the clinic: an allow-list, so that a new field of SessionRecord stays in the clinic until
/// somebody adds it here. `revision` and the parts' `sha256` are set by the caller.
[[nodiscard]] v1::FleetSession facts_of(const v1::SessionRecord& session, const SendRules& rules);

}  // namespace dts::fleet::wire
