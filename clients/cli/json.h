// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace dts::cli {

using Json = nlohmann::ordered_json;

/// Without line ends. Text that is not UTF-8 (a topic may be anything) is repaired, here and in `document`.
[[nodiscard]] std::string one_line(const Json& json);
/// One document, indented, with a line end.
[[nodiscard]] std::string document(const Json& json);
/// Adds a number unless it is undefined (not finite): that is absent, never NaN and never 0.
void set_number(Json& object, std::string_view key, double value);

}  // namespace dts::cli
