// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "record/session_facts.h"

namespace dts::fhir {

/// Returns the UUID (version 5) of one resource of a recording: the same on every machine, and in every export. `what` names the resource
/// within the recording: "patient", "trial/3/1". Recordings of two clinics never give the same UUID: it also depends on the time of the
/// start in ns and on the boot of the rig's computer.
[[nodiscard]] std::string resource_id(const record::SessionFacts& facts, std::string_view what);

}  // namespace dts::fhir
