// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace dts::session {

/// A result of a whole session.
struct SessionFigure {
  std::string name;  ///< "trunk_at_critical_boundary_deg", "eyes-open-two-feet/MVELO"
  double value = 0.0;
  std::string unit;
  std::string details{};  ///< JSON; optional.
};

/// Returns what a result's name ends with: each part of a resumed session has its own results.
[[nodiscard]] inline std::string part_suffix(std::uint32_t part) { return part > 1 ? "_part_" + std::to_string(part) : ""; }
/// Returns a result's name without this end, and the part.
[[nodiscard]] inline std::pair<std::string, std::uint32_t> without_part_suffix(const std::string& name) {
  constexpr std::size_t kLongestNumber = 6;
  const std::size_t digits = name.find_last_not_of("0123456789") + 1;  // npos + 1 is 0
  if (digits == name.size() || name.size() - digits > kLongestNumber) return {name, 1};
  const auto part = static_cast<std::uint32_t>(std::stoul(name.substr(digits)));
  if (!name.ends_with("_part_" + std::to_string(part)) || part < 2) return {name, 1};
  return {name.substr(0, name.size() - part_suffix(part).size()), part};
}

}  // namespace dts::session
