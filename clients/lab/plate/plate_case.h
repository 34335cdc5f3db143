// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "files/toml_reader.h"
#include "physics/plate/solve.h"

namespace dts::lab::plate {

/// A CASE.toml file: plate, support, loads and probes, and how to solve it.
struct PlateCaseFile {
  physics::PlateCase plate_case;
  physics::PlateMethod method = physics::PlateMethod::Fdm;
  std::optional<int> divisions;  ///< Absent: default of the method.
  bool is_nonlinear = false;
  bool spreads_point_loads = false;  ///< `simpson`: thesis eq. 3.13.
};

/// Reads and checks `file`. Adds every error to `problems` with line, column and allowed range. The result is valid for physics::solve only
/// if there were none.
[[nodiscard]] PlateCaseFile read_plate_case(const std::string& file, files::Problems& problems);

}  // namespace dts::lab::plate
