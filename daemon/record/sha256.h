// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace dts::record {

/// Returns the SHA-256 of a text, 64 lower-case hexadecimal digits. Identifies a calibration, a model or a set of training data.
[[nodiscard]] std::string sha256_of(std::string_view text);

}  // namespace dts::record
