// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

// The figures as printed in the thesis. The conditions for which they were computed are fitted (plate-model sections 1 and 3) and are in
// lab/base/thesis_setup.h.

namespace dts::lab::thesis::printed {

inline constexpr std::size_t kLoads = 4;
using ByLoad = std::array<double, kLoads>;

/// Thesis tables 3.2 and 3.3, mm: three sensing positions of Fig. 3.7 under a central load.
struct Deflections {
  ByLoad load_kgf;
  std::array<ByLoad, 3> real_mm;
  std::array<ByLoad, 3> fem_mm;
  std::array<ByLoad, 3> fdm_mm;
};

inline constexpr Deflections kAcrylic{
    .load_kgf = {0.25, 0.5, 0.75, 1.0},
    .real_mm = {{{0.5, 1.0, 1.446, 1.93}, {0.79, 1.53, 2.23, 2.98}, {1.03, 2.1, 3.0, 3.97}}},
    .fem_mm = {{{0.508, 1.015, 1.523, 2.03}, {0.677, 1.354, 2.032, 2.709}, {0.857, 1.715, 2.572, 3.43}}},
    .fdm_mm = {{{0.5, 1.0, 1.501, 2.002}, {0.705, 1.41, 2.116, 2.821}, {0.912, 1.825, 2.737, 3.649}}},
};

inline constexpr Deflections kSteel{
    .load_kgf = {5.0, 10.0, 15.0, 20.0},
    .real_mm = {{{0.34, 0.64, 0.91, 1.19}, {0.52, 1.0, 1.4, 1.78}, {0.72, 1.36, 2.01, 2.61}}},
    .fem_mm = {{{0.342, 0.684, 1.026, 1.3675}, {0.472, 0.943, 1.415, 1.886}, {0.617, 1.233, 1.849, 2.466}}},
    .fdm_mm = {{{0.34, 0.68, 1.02, 1.36}, {0.496, 0.991, 1.487, 1.983}, {0.663, 1.325, 1.988, 2.65}}},
};

/// Thesis tables 3.4 and 3.5: S1/S2 and S1/S3.
struct Proportions {
  std::array<ByLoad, 2> real;
  std::array<ByLoad, 2> fdm;
  std::array<ByLoad, 2> fem;
};

inline constexpr Proportions kAcrylicProportions{
    .real = {{{0.632911, 0.653595, 0.64843, 0.647651}, {0.485437, 0.47619, 0.482, 0.486146}}},
    .fdm = {{{0.70922, 0.70922, 0.709357, 0.709677}, {0.548246, 0.547945, 0.548411, 0.548643}}},
    .fem = {{{0.750369, 0.749631, 0.749508, 0.749354}, {0.592765, 0.591837, 0.592146, 0.591837}}},
};

inline constexpr Proportions kSteelProportions{
    .real = {{{0.653846, 0.64, 0.65, 0.668539}, {0.472222, 0.470588, 0.452736, 0.455939}}},
    .fdm = {{{0.685484, 0.686176, 0.685945, 0.68583}, {0.512821, 0.513208, 0.513078, 0.513208}}},
    .fem = {{{0.724576, 0.725345, 0.725088, 0.72508}, {0.554295, 0.554745, 0.554895, 0.554542}}},
};

inline constexpr std::size_t kLines = 5;

/// A row of thesis table 3.6: mean error of a proportion along five lines of loads, %.
struct LineErrors {
  bool is_opposite;  ///< The two sensors are opposite corners of the sensor square, otherwise neighbours.
  bool is_edge_supported;
  std::array<double, kLines> line_percent;
  double mean_percent;
};

inline constexpr std::array<LineErrors, 4> kLineErrors{{
    {true, true, {0.023, 3.258, 5.144, 5.285, 4.078}, 3.558},
    {true, false, {0.005, 2.518, 2.682, 1.791, 0.648}, 1.529},
    {false, true, {0.056, 4.376, 9.47, 16.045, 23.005}, 11.032},
    {false, false, {0.009, 0.332, 0.63, 0.827, 1.005}, 0.56},
}};

struct Deviation {
  double x_mm;
  double y_mm;
  double total_mm;
};

/// A row of thesis table 4.1.
struct Locus {
  double x_mm;
  double y_mm;
  Deviation simulated;
  Deviation real;
};

inline constexpr std::array<Locus, 15> kLoci{{
    {86.0, 86.0, {2.7, -1.53, 3.15}, {2.03, 1.78, 2.7}},
    {86.0, 118.25, {0.03, 2.37, 2.37}, {0.25, -6.86, 6.86}},
    {118.25, 118.25, {0.5, 0.57, 0.75}, {3.81, -3.81, 5.39}},
    {86.0, 150.5, {0.75, 2.56, 2.66}, {-0.51, 1.02, 1.14}},
    {118.25, 150.5, {0.27, 1.62, 1.64}, {2.29, 2.54, 3.42}},
    {150.5, 150.5, {0.57, 1.23, 1.36}, {1.52, -1.52, 2.16}},
    {86.0, 182.75, {2.14, 0.06, 2.15}, {2.54, 2.54, 3.6}},
    {118.25, 182.75, {0.61, 0.03, 0.61}, {1.27, 3.05, 3.3}},
    {150.5, 182.75, {0.71, -0.22, 0.75}, {-0.51, 0.25, 0.57}},
    {182.75, 182.75, {0.76, -0.2, 0.78}, {1.27, 1.52, 1.9}},
    {86.0, 215.0, {3.43, -2.79, 4.42}, {1.27, -0.76, 1.41}},
    {118.25, 215.0, {0.79, -1.83, 2.0}, {0.51, 1.02, 1.14}},
    {150.5, 215.0, {0.81, -1.8, 2.0}, {1.52, 0.51, 1.61}},
    {182.75, 215.0, {0.8, -1.8, 2.0}, {0.76, 0.0, 0.76}},
    {215.0, 215.0, {0.88, -1.8, 2.0}, {0.51, 0.51, 0.72}},
}};

/// Printed below the table.
inline constexpr Deviation kSimulatedRmse{1.39, 1.63, 2.15};
inline constexpr Deviation kRealRmse{1.66, 2.51, 3.0};

/// A trial of thesis table 4.2: root mean square of the difference between floor platform and force plate.
struct PlateRmse {
  double x_mm;
  double y_mm;
};

/// Table 4.2: V1 to V5, on two feet and on one.
inline constexpr std::array<PlateRmse, 5> kTwoFeetRmse{{{0.6, 0.48}, {0.77, 0.61}, {0.49, 0.4}, {0.94, 0.95}, {0.42, 0.74}}};
inline constexpr std::array<PlateRmse, 5> kOneFootRmse{{{1.09, 1.6}, {1.05, 2.8}, {0.68, 1.66}, {1.0, 1.14}, {1.04, 2.5}}};
/// Printed below the table: the mean of the twenty.
inline constexpr double kMeanPlateRmseMm = 1.05;

// Correct classifications out of 15.

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

}  // namespace dts::lab::thesis::printed
