// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

// Correct classifications out of 15, as the thesis prints them.

namespace dts::lab::printed {

inline constexpr int kTrialsPerCell = 15;

/// For targets at 120 %, 150 % and the maximum reach.
using ByTarget = std::array<int, 3>;

/// Table 5.2: NN2 on A, B and C.
inline constexpr std::array<ByTarget, 3> kTeachersByNn2{{{15, 14, 15}, {15, 15, 15}, {15, 15, 15}}};

struct Classified {
  ByTarget nn1;
  ByTarget nn2;
};

/// Table 6.2: H1 to H10.
inline constexpr std::array<Classified, 10> kHealthy{{
    {{15, 15, 15}, {15, 15, 15}},
    {{15, 12, 15}, {15, 11, 15}},
    {{15, 11, 15}, {15, 11, 15}},
    {{15, 15, 15}, {15, 12, 15}},
    {{15, 15, 15}, {15, 15, 15}},
    {{0, 15, 15}, {15, 15, 15}},
    {{15, 15, 15}, {15, 14, 15}},
    {{11, 15, 15}, {15, 15, 15}},
    {{15, 15, 15}, {15, 15, 15}},
    {{15, 15, 15}, {15, 15, 15}},
}};

/// Totals printed below the table; its own rows sum to 424 and 438.
inline constexpr int kHealthyTotalNn1 = 416;
inline constexpr int kHealthyTotalNn2 = 439;

struct StrokeRow {
  int nn1;
  int nn2;
};

/// Table 6.4: S1 to S5.
inline constexpr std::array<StrokeRow, 5> kStroke{{{10, 11}, {15, 15}, {15, 15}, {15, 15}, {15, 15}}};

}  // namespace dts::lab::printed
