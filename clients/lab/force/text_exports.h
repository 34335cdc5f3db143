// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "lab/force/force_file.h"
#include "lab/force/number_table.h"

namespace dts::lab::force {

/// The format of a text file of force plates.
enum class TextFormat : std::uint8_t { BioWare, Motive, Columns, OpenSim };

/// Returns the format that the first lines have; nothing if they name no component of a force plate.
[[nodiscard]] std::optional<TextFormat> text_format(const Beginning& beginning);

/// Reads a text export. Its columns are found by their names, never by their place:
/// - BioWare (Kistler): Fx Fy Fz, Ax Ay, Mx' My', Tz'; the names again for each further plate
/// - Motive and other tables: Fx .. Mz, Cx Cy or CoPx CoPy, with a number of the plate before or behind the name
/// - OpenSim: ground_force_vx .. pz and ground_torque_x .. z, with what distinguishes the plates before or within the name
/// Units are those in the names or in a row below them; without one, N, N m, and m for the COP. If Fz, Mx and My are there, the COP is
/// computed from them; otherwise it is that of the file. Fails with Failed, naming the line.
[[nodiscard]] core::Result<ForceFile> read_text_export(const std::string& file, const Beginning& beginning, TextFormat format);

}  // namespace dts::lab::force
