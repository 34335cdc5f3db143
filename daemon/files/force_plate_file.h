// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/toml_reader.h"
#include "physics/force_plate/force_plate.h"

namespace dts::files {

/// The table [force_plate]: how the volts of a DAQ become the wrench of a plate.
struct ForcePlateFile {
  std::string kind;  ///< "kistler8", "six_component", "load_cells".
  physics::ForcePlate plate;
  std::optional<physics::PointPolynomial> polynomial;  ///< Of kistler8; absent: the point is not corrected.
  bool is_z_down = true;                               ///< The channels are the action, z down; false: the reaction, z up.
  std::vector<double> tare_volts;                      ///< Subtracted from each channel first; 0 without [force_plate.tare].
};

/// Reads the table at `reader`, with all its keys:
/// - kistler8: scale_mv_per_n (8), or sensitivity_pc_per_n (8), range_pc (8) and full_scale_v; a_mm, b_mm, az0_mm; cop_poly_x, cop_poly_y
/// - six_component: matrix (6 x 6) with matrix_unit, or sensitivity (6 x 6, uV/V per N and N m); excitation_v (6), gain (6); surface_mm
/// - load_cells: position_mm (3 or 4 pairs), scale_n_per_v (one number, or one for each cell)
/// - all: axes, [tare] volts
/// If something is wrong, adds it to `problems` and returns nothing.
[[nodiscard]] std::optional<ForcePlateFile> read_force_plate(TomlReader reader, Problems& problems);

/// Reads a file that has only this table.
[[nodiscard]] std::optional<ForcePlateFile> read_force_plate(const std::string& file, Problems& problems);

}  // namespace dts::files
