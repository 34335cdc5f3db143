// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "classifier/trunk_model.h"
#include "record/session_facts.h"
#include "report/stabilogram.h"
#include "session/protocol.h"

namespace dts::report {

/// What a report needs of the recorded rig; nothing is known if the definition is missing or not readable.
struct RecordedRig {
  std::optional<PlateSize> plate{};
  bool is_force_plate = false;
  bool corrects_two_feet = false;  ///< Its calibration has a correction for two feet.
};
[[nodiscard]] RecordedRig recorded_rig(const record::SessionFacts& facts);
/// Returns the model of the recorded chair that classifies reaches; nothing if there is none or it is not readable.
[[nodiscard]] std::optional<classifier::TrunkModel> recorded_trunk_model(const record::SessionFacts& facts);
/// Returns the recorded protocol for the names of conditions and fields. What cannot be read, or was written for another version, is left
/// out: then the keys are shown.
[[nodiscard]] session::Protocol recorded_protocol(const record::SessionFacts& facts);
/// Returns the number of trials that the protocol plans; 0: none, or unknown.
[[nodiscard]] std::uint32_t planned_trials(const record::SessionFacts& facts);

}  // namespace dts::report
