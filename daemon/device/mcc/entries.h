// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "device/device_entry.h"

namespace dts::device::mcc {

/// Returns one entry per product of this folder, and one for the joined pair.
[[nodiscard]] std::vector<RegistryEntry> registry_entries();

}  // namespace dts::device::mcc
