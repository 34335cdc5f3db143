// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "record/session_facts.h"
#include "report/stabilogram.h"

namespace dts::report {

/// The plate of the rig that was recorded; nothing when the definition is missing or does not read.
[[nodiscard]] std::optional<PlateSize> recorded_plate(const record::SessionFacts& facts);
/// Trials that the protocol plans; 0: it plans none, or is not known.
[[nodiscard]] std::uint32_t planned_trials(const record::SessionFacts& facts);

}  // namespace dts::report
