// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "files/toml_reader.h"
#include "physics/plate/solve.h"

namespace dts::lab {

/// A CASE.toml: plate, support, loads and probes, and how to solve it.
struct PlateCaseFile {
  physics::PlateCase plate_case;
  physics::PlateMethod method = physics::PlateMethod::Fdm;
  std::optional<int> divisions;  ///< Absent: the method's default.
  bool is_nonlinear = false;
  bool spreads_point_loads = false;  ///< `simpson`: thesis eq. 3.13.
};

/// Reads and checks `file`. Everything wrong is added to `problems` with line, column and allowed range; what is returned is
/// fit for physics::solve only when nothing was.
[[nodiscard]] PlateCaseFile read_plate_case(const std::string& file, files::Problems& problems);

}  // namespace dts::lab
