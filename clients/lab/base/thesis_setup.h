// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "physics/plate/plate.h"
#include "physics/rig_model.h"

// Conditions of the thesis's figures, where they can be known: printed in the thesis, or fitted to its FEM columns (plate-model sections
// 1-4).

namespace dts::lab::thesis_setup {

inline constexpr double kNewtonsPerKgf = 9.80665;
inline constexpr int kDivisions = 40;  ///< Thesis 3.4.2.

/// Thesis Table 3.1 and 3.4: the acrylic verification plate.
[[nodiscard]] inline physics::Plate acrylic() { return {.a = {430.0}, .b = {430.0}, .h = {4.0}, .e_pa = 3.5e9, .nu = 0.31}; }
[[nodiscard]] inline physics::Plate steel() { return {.a = {430.0}, .b = {430.0}, .h = {3.0}, .e_pa = 198.7e9, .nu = 0.27}; }

/// To match the printed figures, the acrylic columns need supports exactly at the corners, the steel ones about 11 mm inside: the size of
/// an M6 nut, one mesh cell.
inline constexpr physics::Support kAcrylicSupport{.kind = physics::SupportKind::Corner, .inset = {0.0}};
inline constexpr physics::Support kSteelSupport{.kind = physics::SupportKind::Corner, .inset = {10.75}};

inline constexpr double kSensorMm = 86.0;      ///< From the edges; node 8 of 40.
inline constexpr double kFarSensorMm = 344.0;  ///< Position of the sensors on the other side.
inline constexpr physics::Point kCentre{{215.0}, {215.0}};

/// Sensing positions 1, 2 and 3 of Fig. 3.7: on the diagonal, between two neighbouring sensors, at the centre.
inline constexpr std::array<physics::Point, 3> kSensingPositions{{{{86.0}, {86.0}}, {{215.0}, {86.0}}, {{215.0}, {215.0}}}};

/// Returns the floor platform of chapter 4; every command uses it if no rig file is specified.
[[nodiscard]] physics::RigModel floor_platform();

}  // namespace dts::lab::thesis_setup
