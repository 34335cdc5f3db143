// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "golden/golden_case.h"

namespace dts::golden {

/// Runs a whole rig, from a device that plays the scans to what the publisher sends, and returns one line a message.
///
///     test thread: one block or command, then wait until all three threads have nothing left to do
///     device -> rig thread (or publish thread) -> lines
///
/// So the order of the lines depends on nothing but the case. Throws std::runtime_error if a step is unknown or a thread hangs.
[[nodiscard]] std::vector<std::string> run(const Case& golden, const Scans& scans);

}  // namespace dts::golden
