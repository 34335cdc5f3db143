// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "c3d/parameters.h"

namespace dts::c3d {

/// x, y, z of the corners (+x +y), (-x +y), (-x -y), (+x -y) of a plate, in the axes of the laboratory.
using Corners = std::array<std::array<double, 3>, 4>;

/// What FORCE_PLATFORM says about one plate, as it is in the file. Lengths are in POINT:UNITS.
struct ForcePlatform {
  std::optional<int> type;
  std::optional<std::array<double, 3>> origin;
  std::optional<Corners> corners;
  std::vector<std::size_t> channels;          ///< Counted from 1; 0: no number of a channel.
  std::optional<std::vector<double>> matrix;  ///< 36 numbers, one column after the other; absent: not there, not of 6 x 6, or not finite.
  std::optional<std::array<double, 12>> polynomial;  ///< FPCOPPOLY: 6 of x, 6 of y.
};

struct ForcePlatforms {
  std::vector<ForcePlatform> plates;
  std::optional<std::array<int, 2>> zero_frames;  ///< ZERO: first and last frame, counted from 1.
};

/// Reads FORCE_PLATFORM; at most 255 plates. Values that are missing or not finite are absent.
[[nodiscard]] ForcePlatforms force_platforms(const Parameters& parameters);

}  // namespace dts::c3d
