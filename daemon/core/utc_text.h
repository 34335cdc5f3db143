// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dts::core {

/// Returns ISO 8601 text, "2026-11-21T14:45:25.125000Z"; truncates to microseconds.
[[nodiscard]] std::string utc_text(std::int64_t utc_ns);

}  // namespace dts::core
