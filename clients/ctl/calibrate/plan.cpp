// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/plan.h"

#include <algorithm>

namespace dts::ctl {
namespace {

constexpr std::size_t kMidlinePoints = 5;  // thesis 4.4

/// Range of the sensors' rectangle along one axis.
struct Extent {
  double first = 0.0;
  double last = 0.0;

  [[nodiscard]] double at(std::size_t index, std::size_t count) const {
    return first + (last - first) * static_cast<double>(index) / static_cast<double>(count - 1);
  }
  [[nodiscard]] double middle() const { return 0.5 * (first + last); }
};

Extent extent(const std::vector<double>& positions) {
  const auto [first, last] = std::ranges::minmax(positions);
  return {first, last};
}

}  // namespace

PlateView plate_view(const v1::RigInfo& rig) {
  PlateView view{.a_mm = rig.plate_a_mm(), .b_mm = rig.plate_b_mm()};
  for (const v1::SensorInfo& sensor : rig.sensors()) {
    view.labels.push_back(sensor.label());
    view.sensor_x_mm.push_back(sensor.x_mm());
    view.sensor_y_mm.push_back(sensor.y_mm());
  }
  return view;
}

std::vector<PlannedPoint> plan_points(const PlateView& plate, physics::CopMethod method, const std::vector<double>& loads_n,
                                      std::size_t grid) {
  const Extent x = extent(plate.sensor_x_mm);
  const Extent y = extent(plate.sensor_y_mm);
  std::vector<PlannedPoint> points;
  for (const double load_n : loads_n) {
    if (method == physics::CopMethod::Thesis) {
      for (std::size_t k = 0; k < kMidlinePoints; ++k) points.push_back({x.at(k, kMidlinePoints), y.middle(), load_n});
      for (std::size_t k = 0; k < kMidlinePoints; ++k) points.push_back({x.middle(), y.at(k, kMidlinePoints), load_n});
      continue;
    }
    for (std::size_t row = 0; row < grid; ++row) {
      for (std::size_t step = 0; step < grid; ++step) {
        const std::size_t column = row % 2 == 0 ? step : grid - 1 - step;
        points.push_back({x.at(column, grid), y.at(row, grid), load_n});
      }
    }
  }
  return points;
}

std::vector<PlannedPoint> verification_points(const PlateView& plate, double load_n, std::size_t count) {
  constexpr std::size_t kSteps = 5;  // from a sensor to the centre
  const Extent x = extent(plate.sensor_x_mm);
  const Extent y = extent(plate.sensor_y_mm);
  std::vector<PlannedPoint> all;
  for (std::size_t row = 0; row < kSteps; ++row) {
    for (std::size_t column = 0; column <= row; ++column) {
      all.push_back({Extent{x.first, x.middle()}.at(column, kSteps), Extent{y.first, y.middle()}.at(row, kSteps), load_n});
    }
  }
  std::vector<PlannedPoint> chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(all[k * (all.size() - 1) / std::max<std::size_t>(1, count - 1)]);
  return chosen;
}

}  // namespace dts::ctl
