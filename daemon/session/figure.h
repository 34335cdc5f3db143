// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

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

}  // namespace dts::session
