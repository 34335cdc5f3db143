// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lab/force/number_table.h"

namespace dts::lab::force {

/// Where a value is in a row, and what to multiply it by: to s, N, N m or mm.
struct ColumnPlace {
  std::size_t place = 0;
  double scale = 1.0;
};

/// The columns of one plate. Absent: the file does not have the component.
struct PlateColumns {
  std::array<std::optional<ColumnPlace>, 3> force;
  std::array<std::optional<ColumnPlace>, 3> moment;
  std::array<std::optional<ColumnPlace>, 3> surface_moment;  ///< With a prime: BioWare's sign for those about the surface.
  std::array<std::optional<ColumnPlace>, 3> cop;
  std::optional<ColumnPlace> free_moment;

  [[nodiscard]] bool has_cop() const noexcept { return cop[0] && cop[1]; }
};

struct NamedColumns {
  std::optional<ColumnPlace> time;
  std::vector<PlateColumns> plates;  ///< In the order of their first columns.
};

/// Finds time, forces, moments and COP by name. `units` is the row below the names, or empty. Returns no plates if the names are none of a
/// force plate.
[[nodiscard]] NamedColumns named_columns(const std::vector<TextCell>& names, const std::vector<TextCell>& units);

/// The same for the names of OpenSim.
[[nodiscard]] NamedColumns opensim_columns(const std::vector<TextCell>& names);

}  // namespace dts::lab::force
