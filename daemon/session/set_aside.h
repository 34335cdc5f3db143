// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/result.h"

namespace dts::session {

/// Renames the catalogue and all its files beside it; deletes and replaces nothing. Returns the new name. Thread: control.
[[nodiscard]] core::Result<std::string> set_aside(const std::string& catalogue, std::int64_t utc_ns);
/// Returns whether a power cut interrupted `set_aside` between its renames.
[[nodiscard]] bool is_half_set_aside(const std::string& catalogue);

}  // namespace dts::session
