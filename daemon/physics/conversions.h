// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

namespace dts::physics {

inline constexpr double kMillimetresPerMetre = 1e3;
inline constexpr double kSquareMillimetresPerSquareMetre = 1e6;
inline constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

}  // namespace dts::physics
