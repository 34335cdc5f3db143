// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include "core/block.h"
#include "core/result.h"

namespace dts::pipeline {

/// Checks that every stage does in `prepare`. Fails with InvalidArgument, naming `stage` and the value, for no or too many channels, empty
/// or too large blocks, or channels in a unit other than `unit` (empty: any).
[[nodiscard]] core::Status check_input(std::string_view stage, const core::StreamFormat& input, std::size_t max_scans,
                                       std::string_view unit);

}  // namespace dts::pipeline
