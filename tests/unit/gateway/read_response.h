// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "gateway/http/http_message.h"

namespace dts::gateway {

/// The value of a header, or "".
inline std::string header_of(const HttpResponse& response, const std::string& name) {
  for (const auto& [key, value] : response.headers) {
    if (key == name) return value;
  }
  return {};
}

inline std::string text_of(const HttpResponse& response) { return std::get<std::string>(response.body); }
inline nlohmann::json json_of(const HttpResponse& response) { return nlohmann::json::parse(text_of(response)); }
inline const FileBody& file_of(const HttpResponse& response) { return std::get<FileBody>(response.body); }

}  // namespace dts::gateway
