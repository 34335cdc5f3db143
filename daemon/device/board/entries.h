// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "device/device_entry.h"

namespace dts::device::board {

/// Returns "serial:", "tcp:" and "exec:", for the registry.
[[nodiscard]] std::vector<RegistryEntry> registry_entries();

}  // namespace dts::device::board
