// SPDX-License-Identifier: Apache-2.0
// The details of results: JSON of the daemon, read without trust.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "dts/v1/sessions.pb.h"

namespace dts::visits {

/// Returns the details of a result; an empty object if they are no object.
[[nodiscard]] nlohmann::json details_of(const v1::SessionResult& result);
/// Returns a finite number; nothing if the member is missing or something else.
[[nodiscard]] std::optional<double> number_in(const nlohmann::json& details, const char* key);
/// Returns a text; empty if the member is missing or something else.
[[nodiscard]] std::string text_in(const nlohmann::json& details, const char* key);
/// Returns a number of trials or reaches, at most a million.
[[nodiscard]] std::optional<std::uint32_t> count_in(const nlohmann::json& details, const char* key);

}  // namespace dts::visits
