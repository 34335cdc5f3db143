// SPDX-License-Identifier: Apache-2.0
// What the elastic plate costs: from nothing to 16 influence rows at 40 x 40 divisions, beside two baselines in the same run, a
// straightforward Eigen::SimplicialLDLT of the same system and the non-conforming rectangle; each with its error against a converged
// solution. Then a simulated platform of 16 sensors at 1500 Hz. CPU time; rounds are interleaved; the tables show medians.
#include <time.h>

#include <CLI/CLI.hpp>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "bench/nonconforming_plate.h"
#include "core/clock.h"
#include "device/registry.h"
#include "physics/plate/discretisation.h"
#include "physics/plate/influence_table.h"
#include "physics/plate/solve.h"
#include "physics/rig_model.h"

namespace dts::bench {
namespace {

using physics::Point;
using Matrix = Eigen::SparseMatrix<double>;

constexpr int kDivisions = 40;
constexpr double kStiffnessOfSupports = 1e6;  // of D/l^2, as in the physics
const physics::Plate kPlate{};                // the thesis's steel platform
const physics::Support kSupport{.kind = physics::SupportKind::Corner, .inset = {10.75}};
const Point kLoad{{193.5}, {247.25}};

std::vector<Point> sixteen_sensors() {
  std::vector<Point> sensors;
  for (int k = 0; k < 16; ++k) sensors.push_back({{86.0 + 86.0 * (k % 4)}, {86.0 + 86.0 * (k / 4)}});
  return sensors;
}

double cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

/// Deflections of the sensors under 1 N at kLoad, m.
using Deflections = std::vector<double>;

/// Factorises and solves once per sensor; `row` gives a point's weights in the degrees of freedom.
template <class Row>
Deflections influence_of_load(const Matrix& stiffness, Row row) {
  const Eigen::SimplicialLDLT<Matrix> factor(stiffness);
  const Eigen::VectorXd load = row(kLoad);
  Deflections result;
  for (const Point& sensor : sixteen_sensors()) result.push_back(factor.solve(row(sensor)).dot(load));
  return result;
}

template <class Row>
void add_corner_supports(std::vector<Eigen::Triplet<double>>& triplets, double spacing_squared, Row row) {
  for (const double x : {10.75, 419.25}) {
    for (const double y : {10.75, 419.25}) {
      const Eigen::VectorXd weights = row(Point{{x}, {y}});
      for (int a = 0; a < weights.size(); ++a) {
        if (weights[a] == 0.0) continue;
        for (int b = 0; b < weights.size(); ++b) {
          if (weights[b] != 0.0)
            triplets.emplace_back(a, b, kStiffnessOfSupports * kPlate.rigidity_nm() / spacing_squared * weights[a] * weights[b]);
        }
      }
    }
  }
}

/// The system of a discretisation, assembled and factorised as a textbook would.
Deflections textbook(const physics::Discretisation& discretisation) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& [row, column, value] : discretisation.stiffness()) triplets.emplace_back(row, column, value);
  const auto row = [&](const Point& point) {
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(discretisation.dof_count());
    for (const auto& [dof, weight] : discretisation.force({.centre = point})) weights[dof] += weight;
    return weights;
  };
  add_corner_supports(triplets, discretisation.grid().dx_m * discretisation.grid().dy_m, row);
  Matrix stiffness(discretisation.dof_count(), discretisation.dof_count());
  stiffness.setFromTriplets(triplets.begin(), triplets.end());
  return influence_of_load(stiffness, row);
}

Deflections nonconforming(int divisions) {
  const physics::Grid grid = physics::Grid::over(kPlate, divisions);
  const NonconformingElement element(grid.dx_m, grid.dy_m, kPlate.rigidity_nm(), kPlate.nu);
  const auto dof = [&](int i, int j, int k) {  // k = 3 * node of the cell + (w, w_x, w_y)
    const int corner = k / 3;
    return 3 * grid.node(i + (corner == 1 || corner == 2 ? 1 : 0), j + corner / 2) + k % 3;
  };
  std::vector<Eigen::Triplet<double>> triplets;
  for (int cell = 0; cell < divisions * divisions; ++cell) {
    const int i = cell % divisions;
    const int j = cell / divisions;
    for (int a = 0; a < 12; ++a) {
      for (int b = 0; b < 12; ++b) triplets.emplace_back(dof(i, j, a), dof(i, j, b), element.stiffness()(a, b));
    }
  }
  const auto row = [&](const Point& point) {
    const double x_m = 1e-3 * point.x.value;
    const double y_m = 1e-3 * point.y.value;
    const int i = std::min(static_cast<int>(x_m / grid.dx_m), divisions - 1);
    const int j = std::min(static_cast<int>(y_m / grid.dy_m), divisions - 1);
    const auto reading = element.reading(x_m - i * grid.dx_m, y_m - j * grid.dy_m);
    Eigen::VectorXd weights = Eigen::VectorXd::Zero(3 * grid.node_count());
    for (int k = 0; k < 12; ++k) weights[dof(i, j, k)] += reading[k];
    return weights;
  };
  add_corner_supports(triplets, grid.dx_m * grid.dy_m, row);
  Matrix stiffness(3 * grid.node_count(), 3 * grid.node_count());
  stiffness.setFromTriplets(triplets.begin(), triplets.end());
  return influence_of_load(stiffness, row);
}

Deflections influence_table() {
  const auto sensors = sixteen_sensors();
  const auto table = physics::InfluenceTable::create(kPlate, kSupport, sensors, kDivisions).value();
  Deflections result;
  for (std::size_t k = 0; k < sensors.size(); ++k) result.push_back(1e-3 * table.at_point_mm_per_n(k, kLoad));
  return result;
}

Deflections converged() {
  const physics::PlateCase plate_case{kPlate, kSupport, {{.area = {.centre = kLoad}, .force = {1.0}}}, sixteen_sensors()};
  const auto solution = physics::solve(plate_case, physics::PlateMethod::Fem, {.divisions = 100}).value();
  Deflections result;
  for (const auto& probe : solution.probes) result.push_back(1e-3 * probe.deflection_mm);
  return result;
}

struct Contender {
  std::string name;
  std::function<Deflections()> run;
  std::vector<double> ms{};
  double error_percent = 0.0;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double largest_error_percent(const Deflections& found, const Deflections& expected) {
  double largest = 0.0;
  for (std::size_t k = 0; k < found.size(); ++k) largest = std::max(largest, 100.0 * std::abs(found[k] / expected[k] - 1.0));
  return largest;
}

void compare_solvers(int rounds) {
  std::vector<Contender> contenders = {
      {"**finite differences, influence table**", influence_table},
      {"finite differences, textbook SimplicialLDLT", [] { return textbook(*physics::make_fdm(kPlate, kSupport, kDivisions)); }},
      {"**conforming element**, 40 x 40", [] { return textbook(*physics::make_fem(kPlate, kDivisions)); }},
      {"**conforming element**, 20 x 20", [] { return textbook(*physics::make_fem(kPlate, kDivisions / 2)); }},
      {"non-conforming element, 40 x 40", [] { return nonconforming(kDivisions); }},
      {"non-conforming element, 80 x 80", [] { return nonconforming(2 * kDivisions); }},
  };
  const Deflections expected = converged();
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < contenders.size(); ++k) {
      Contender& contender = contenders[(k + static_cast<std::size_t>(round)) % contenders.size()];
      const double start = cpu_ms();
      const Deflections found = contender.run();
      contender.ms.push_back(cpu_ms() - start);
      contender.error_percent = largest_error_percent(found, expected);
    }
  }
  const double baseline = median(contenders[1].ms);
  std::printf(
      "| assembly, factorisation, 16 influence rows | ms, median (best) | ratio | largest error at 16 sensors |\n|---|---|---|---|\n");
  for (const Contender& contender : contenders) {
    std::printf("| %s | %.2f (%.2f) | %.2f | %.3f %% |\n", contender.name.c_str(), median(contender.ms), std::ranges::min(contender.ms),
                median(contender.ms) / baseline, contender.error_percent);
  }
}

double seconds_per_cpu_second(const std::string& uri, const physics::RigModel& rig) {
  core::VirtualClock clock{1'000'000'000'000};
  const auto device = device::create_device(uri, {clock, rig}).value();
  constexpr std::size_t kBlockScans = 30;
  constexpr double kRateHz = 1500.0;
  if (!device->open()) return 0.0;
  (void)device->start({core::Rate::from_hz(kRateHz).value(), kBlockScans}).value();
  core::Block block(device->describe().channels.size(), kBlockScans);
  std::size_t scans = 0;
  const double start = cpu_ms();
  while (scans < 30'000) {
    (void)device->read(block, std::numeric_limits<std::int64_t>::max());
    scans += block.count();
  }
  return static_cast<double>(scans) / kRateHz / (1e-3 * (cpu_ms() - start));
}

void simulate(int rounds) {
  physics::RigModel rig{.plate = kPlate, .support = kSupport, .sensors = {}};
  for (const Point& sensor : sixteen_sensors()) {
    rig.sensors.push_back({.label = "w", .position = sensor, .curve = physics::SensorCurve::hoa1405_assumed()});
  }
  std::printf("\n| simulated platform, 16 sensors, 1500 Hz | times real time | of one core |\n|---|---|---|\n");
  for (const std::string plate : {"nonlinear", "linear"}) {
    std::vector<double> factors;
    for (int round = 0; round < rounds; ++round) factors.push_back(seconds_per_cpu_second("sim:floor?step_on_s=0&plate=" + plate, rig));
    std::printf("| %s plate | %.0f | %.2f %% |\n", plate.c_str(), median(factors), 100.0 / median(factors));
  }
}

}  // namespace
}  // namespace dts::bench

int main(int argc, char** argv) {
  int rounds = 9;
  CLI::App app{"Cost of the elastic plate, as Markdown tables"};
  app.add_option("--reps", rounds, "rounds; the median counts")->check(CLI::Range(1, 1000))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  std::printf("g++ %s, CPU time, %d interleaved rounds, steel platform, load at (193.5, 247.25) mm\n\n", __VERSION__, rounds);
  dts::bench::compare_solvers(rounds);
  dts::bench::simulate(rounds);
  return 0;
}
