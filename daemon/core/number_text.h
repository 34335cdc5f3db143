// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::core {

/// Returns the shortest digits that are exactly the value, for messages. No exponent from 0.00001 to a thousand million: 1000000, 1e+12.
[[nodiscard]] std::string number_text(double value);

}  // namespace dts::core
