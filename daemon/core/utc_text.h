// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dts::core {

/// ISO 8601, "2026-11-21T14:45:25.125000Z"; what is below a microsecond is cut off.
[[nodiscard]] std::string utc_text(std::int64_t utc_ns);

}  // namespace dts::core
