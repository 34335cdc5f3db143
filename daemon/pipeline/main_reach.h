// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "core/reach.h"

namespace dts::pipeline {

/// Which reach of a trial is meant: of all events told in it, the last Final of each number that was not cancelled, and of these the one
/// with the largest swing P3 - P2; a reach that is minor or only dips stands behind every other. Nothing when there is no Final.
[[nodiscard]] std::optional<core::ReachEvent> main_reach(std::span<const core::ReachEvent> events);

}  // namespace dts::pipeline
