// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace dts::cli {

using Json = nlohmann::ordered_json;

/// Returns one document without line ends. Replaces bytes that are not UTF-8 (a topic may have any bytes), as `document` does.
[[nodiscard]] std::string one_line(const Json& json);
/// Returns one document, indented, with a line end.
[[nodiscard]] std::string document(const Json& json);
/// Adds a number, but only if it is finite: an undefined number is absent, never NaN and never 0.
void set_number(Json& object, std::string_view key, double value);

}  // namespace dts::cli
