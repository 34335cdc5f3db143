// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::session {

/// A result of a whole session.
struct SessionFigure {
  std::string name;  ///< "trunk_at_critical_boundary_deg", "eyes-open-two-feet/MVELO"
  double value = 0.0;
  std::string unit;
  std::string details{};  ///< JSON; optional.
};

}  // namespace dts::session
