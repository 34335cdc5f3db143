// SPDX-License-Identifier: Apache-2.0
#include "visits/details.h"

#include <cmath>

namespace dts::visits {

nlohmann::json details_of(const v1::SessionResult& result) {
  constexpr std::size_t kLongest = 1U << 20U;
  if (result.details().size() > kLongest) return nlohmann::json::object();
  auto details = nlohmann::json::parse(result.details(), nullptr, false);
  return details.is_object() ? details : nlohmann::json::object();
}

std::optional<double> number_in(const nlohmann::json& details, const char* key) {
  const auto found = details.find(key);
  if (found == details.end() || !found->is_number()) return std::nullopt;
  const auto value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string text_in(const nlohmann::json& details, const char* key) {
  const auto found = details.find(key);
  return found != details.end() && found->is_string() ? found->get<std::string>() : std::string();
}

std::optional<std::uint32_t> count_in(const nlohmann::json& details, const char* key) {
  const auto value = number_in(details, key);
  return value && *value >= 0.0 && *value <= 1e6 ? std::optional(static_cast<std::uint32_t>(*value)) : std::nullopt;
}

}  // namespace dts::visits
