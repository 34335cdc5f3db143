// SPDX-License-Identifier: Apache-2.0
#include "physics/plate/discretisation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <vector>

#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using test::at;
using test::corners;
using test::steel_plate;

constexpr int kDivisions = 10;

using Matrix = std::vector<std::vector<double>>;

Matrix dense_stiffness(const Plate& plate, const Grid& grid) {
  const auto size = static_cast<std::size_t>(grid.node_count());
  Matrix matrix(size, std::vector<double>(size, 0.0));
  for (const auto& entry : make_fdm(plate, corners(0.0), grid.divisions)->stiffness()) {
    matrix[static_cast<std::size_t>(entry.row())][static_cast<std::size_t>(entry.col())] += entry.value();
  }
  return matrix;
}

std::vector<double> forces(const Matrix& stiffness, const std::vector<double>& deflections) {
  std::vector<double> result;
  for (const auto& row : stiffness) result.push_back(std::inner_product(row.begin(), row.end(), deflections.begin(), 0.0));
  return result;
}

template <class Function>
std::vector<double> field(const Grid& grid, Function function) {
  std::vector<double> values;
  for (int j = 0; j <= grid.divisions; ++j) {
    for (int i = 0; i <= grid.divisions; ++i) values.push_back(function(i * grid.dx_m, j * grid.dy_m));
  }
  return values;
}

/// Offset (i, j) from the row's node -> coefficient in D / l^2.
using Row = std::map<std::pair<int, int>, double>;

struct RowCase {
  const char* name;
  int i;
  int j;
  Row (*expected)(double nu);
};

// The table of plate-model section 2. Nodes lie at the left edge or the lower left corner; the test mirrors them.
const RowCase kRows[] = {
    {"interior", 5, 5,
     [](double) -> Row {
       return {{{0, 0}, 20}, {{1, 0}, -8},  {{-1, 0}, -8}, {{0, 1}, -8}, {{0, -1}, -8}, {{1, 1}, 2}, {{-1, 1}, 2},
               {{1, -1}, 2}, {{-1, -1}, 2}, {{2, 0}, 1},   {{-2, 0}, 1}, {{0, 2}, 1},   {{0, -2}, 1}};
     }},
    {"one in from an edge", 1, 5,
     [](double nu) -> Row {
       return {{{0, 0}, 19}, {{0, 1}, -8},           {{0, -1}, -8},     {{0, 2}, 1},        {{0, -2}, 1}, {{1, 0}, -8},
               {{2, 0}, 1},  {{-1, 0}, -6 + 2 * nu}, {{-1, 1}, 2 - nu}, {{-1, -1}, 2 - nu}, {{1, 1}, 2},  {{1, -1}, 2}};
     }},
    {"diagonal neighbour of the corner", 1, 1,
     [](double nu) -> Row {
       return {{{0, 0}, 18},           {{1, 0}, -8},           {{0, 1}, -8},      {{2, 0}, 1},       {{0, 2}, 1},           {{1, 1}, 2},
               {{-1, 0}, -6 + 2 * nu}, {{0, -1}, -6 + 2 * nu}, {{-1, 1}, 2 - nu}, {{1, -1}, 2 - nu}, {{-1, -1}, 2 - 2 * nu}};
     }},
    {"edge", 0, 5,
     [](double nu) -> Row {
       const double along = -4 + 2 * nu + 2 * nu * nu;
       const double far = (1 - nu * nu) / 2;
       return {{{0, 0}, 8 - 4 * nu - 3 * nu * nu},
               {{0, 1}, along},
               {{0, -1}, along},
               {{0, 2}, far},
               {{0, -2}, far},
               {{1, 0}, -6 + 2 * nu},
               {{2, 0}, 1},
               {{1, 1}, 2 - nu},
               {{1, -1}, 2 - nu}};
     }},
    {"edge next to the corner", 0, 1,
     [](double nu) -> Row {
       return {{{0, 0}, 7.5 - 4 * nu - 2.5 * nu * nu},
               {{0, -1}, -3 + 2 * nu + nu * nu},
               {{0, 1}, -4 + 2 * nu + 2 * nu * nu},
               {{0, 2}, (1 - nu * nu) / 2},
               {{1, 0}, -6 + 2 * nu},
               {{2, 0}, 1},
               {{1, 1}, 2 - nu},
               {{1, -1}, 2 - nu}};
     }},
    {"corner", 0, 0,
     [](double nu) -> Row {
       const double near = -3 + 2 * nu + nu * nu;
       const double far = (1 - nu * nu) / 2;
       return {{{0, 0}, 3 - 2 * nu - nu * nu}, {{1, 0}, near}, {{0, 1}, near}, {{2, 0}, far}, {{0, 2}, far}, {{1, 1}, 2 - 2 * nu}};
     }},
};

/// One of the eight ways to put the plate onto itself.
std::pair<int, int> turned(int i, int j, unsigned symmetry) {
  if ((symmetry & 1U) != 0) i = kDivisions - i;
  if ((symmetry & 2U) != 0) j = kDivisions - j;
  if ((symmetry & 4U) != 0) std::swap(i, j);
  return {i, j};
}

void expect_row(const Matrix& stiffness, const Grid& grid, const RowCase& row, double nu, double unit, unsigned symmetry) {
  const auto [at_i, at_j] = turned(row.i, row.j, symmetry);
  auto left = stiffness[static_cast<std::size_t>(grid.node(at_i, at_j))];
  for (const auto& [offset, coefficient] : row.expected(nu)) {
    const auto [i, j] = turned(row.i + offset.first, row.j + offset.second, symmetry);
    left[static_cast<std::size_t>(grid.node(i, j))] -= coefficient * unit;
  }
  for (const double rest : left) EXPECT_NEAR(rest / unit, 0.0, 1e-11) << row.name << ", nu " << nu << ", symmetry " << symmetry;
}

TEST(Fdm, SquareMesh_HasTheRowsOfTheSheet) {
  for (const double nu : {0.0, 0.27, 0.45, -0.3}) {
    Plate plate = steel_plate();
    plate.nu = nu;
    const Grid grid = Grid::over(plate, kDivisions);
    const double unit = plate.rigidity_nm() / (grid.dx_m * grid.dx_m);

    const Matrix stiffness = dense_stiffness(plate, grid);

    for (const auto& row : kRows) {
      for (unsigned symmetry = 0; symmetry < 8; ++symmetry) expect_row(stiffness, grid, row, nu, unit, symmetry);
    }
  }
}

TEST(Fdm, RigidMotion_NeedsNoForce) {
  Plate plate = steel_plate();
  plate.b = {290.0};
  const Grid grid = Grid::over(plate, kDivisions);
  const Matrix stiffness = dense_stiffness(plate, grid);
  const double unit = plate.rigidity_nm() / (grid.dx_m * grid.dy_m);

  for (const auto& motion : {field(grid, [](double, double) { return 1.0; }), field(grid, [](double x, double) { return x; }),
                             field(grid, [](double, double y) { return y; })}) {
    for (const double force : forces(stiffness, motion)) EXPECT_NEAR(force / unit, 0.0, 1e-11);
  }
}

TEST(Fdm, Twist_NeedsFourCornerForces) {
  Plate plate = steel_plate();
  plate.b = {290.0};
  const Grid grid = Grid::over(plate, kDivisions);
  const double corner_force = 2.0 * (1.0 - plate.nu) * plate.rigidity_nm();

  const auto result = forces(dense_stiffness(plate, grid), field(grid, [](double x, double y) { return x * y; }));

  for (int j = 0; j <= kDivisions; ++j) {
    for (int i = 0; i <= kDivisions; ++i) {
      const bool is_corner = (i == 0 || i == kDivisions) && (j == 0 || j == kDivisions);
      const double expected = !is_corner ? 0.0 : (i == j || (i == kDivisions && j == kDivisions)) ? corner_force : -corner_force;
      EXPECT_NEAR(result[static_cast<std::size_t>(grid.node(i, j))], expected, 1e-9 * corner_force) << i << ", " << j;
    }
  }
}

TEST(Fdm, Force_KeepsSumAndMoment) {
  const Plate plate = steel_plate();
  const auto fdm = make_fdm(plate, corners(0.0), kDivisions);
  const Grid& grid = fdm->grid();

  for (const Point& point : {at(0, 0), at(43, 43), at(100.3, 7.9), at(215, 430), at(430, 430)}) {
    double sum = 0.0;
    double x_mm = 0.0;
    double y_mm = 0.0;
    for (const auto& [node, weight] : fdm->force({.centre = point})) {
      sum += weight;
      x_mm += weight * grid.dx_mm() * (node % (kDivisions + 1));
      y_mm += weight * grid.dy_mm() * (node / (kDivisions + 1));
    }
    EXPECT_NEAR(sum, 1.0, 1e-14);
    EXPECT_NEAR(x_mm, point.x.value, 1e-10);
    EXPECT_NEAR(y_mm, point.y.value, 1e-10);
  }
}

TEST(Fdm, Reading_IsExactForCubicsInside) {
  const auto fdm = make_fdm(steel_plate(), corners(0.0), kDivisions);
  const Grid& grid = fdm->grid();
  const auto cubic = [](double x, double y) { return 1.0 + 2.0 * x - 3.0 * y * y * y + 4.0 * x * x * y; };
  const auto values = field(grid, cubic);

  for (const Point& point : {at(86, 100), at(215, 215), at(301.7, 99.9)}) {
    double read = 0.0;
    for (const auto& [node, weight] : fdm->reading(point)) read += weight * values[static_cast<std::size_t>(node)];
    EXPECT_NEAR(read, cubic(1e-3 * point.x.value, 1e-3 * point.y.value), 1e-12);
  }
}

TEST(Fdm, Simpson_SpreadsOneForceOverNineNodes) {
  // Thesis eq. 3.13: 16/36, 4/36, 1/36.
  const auto fdm = make_fdm(steel_plate(), corners(0.0), kDivisions);
  const Grid& grid = fdm->grid();
  std::map<int, double> shares;
  for (const auto& [node, weight] : spread_by_simpson(grid, fdm->force({.centre = at(215, 215)}))) shares[node] += weight;

  EXPECT_NEAR(shares[grid.node(5, 5)], 16.0 / 36.0, 1e-15);
  EXPECT_NEAR(shares[grid.node(4, 5)], 4.0 / 36.0, 1e-15);
  EXPECT_NEAR(shares[grid.node(6, 6)], 1.0 / 36.0, 1e-15);

  double sum = 0.0;
  for (const auto& [node, weight] : spread_by_simpson(grid, fdm->force({.centre = at(0, 430)}))) sum += weight;
  EXPECT_NEAR(sum, 1.0, 1e-15) << "at a corner nothing falls off";
}

}  // namespace
}  // namespace dts::physics
