// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "core/reach.h"

namespace dts::pipeline {

/// Returns the main reach of a trial: of all its reaches with a Final that was not cancelled later, the one with the largest swing P3 - P2
/// in its last Final. A minor reach or a dip only counts if there is no other. Returns nothing without a Final.
[[nodiscard]] std::optional<core::ReachEvent> main_reach(std::span<const core::ReachEvent> events);

}  // namespace dts::pipeline
