// SPDX-License-Identifier: Apache-2.0
#include "lab/place/placement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "physics/cop/cop_estimator.h"
#include "physics/cop/cop_evaluation.h"
#include "physics/plate/influence_table.h"

namespace dts::lab::place {
namespace {

using physics::InfluenceTable;
using physics::Point;
using physics::RigModel;

constexpr double kFirstMm = 20.0;
constexpr double kStepMm = 5.0;
constexpr double kLastPart = 1.0 / 3.0;  ///< Of the shorter side: at larger distances the sensors measure too little of the plate.
constexpr double kLoadN = 490.0;
// A real sensor (plate-model section 5): noise and steps of each sample, mean of three samples.
constexpr double kNoiseV = 0.003;
constexpr double kStepV = 10.0 / 2048.0;
constexpr double kWindowScans = 3.0;
constexpr int kPlacementGrid = 17;
constexpr double kMargin = 0.2;  ///< Fraction of the plate, at each side: 86..344 mm of the thesis's plate.
constexpr std::size_t kPlacementStances = 200;
constexpr std::uint64_t kPlacementSeed = 4;
constexpr physics::Interval kPersonN{300.0, 900.0};

/// Returns the noise of a sensor in mm at this deflection of the plate.
double noise_mm(const physics::SensorModel& sensor, double deflection_mm) {
  constexpr core::Millimetres kHalfStep{0.05};
  const core::Millimetres gap = sensor.unloaded_gap - core::Millimetres{deflection_mm};
  const double slope_v_per_mm = (sensor.curve.volts(gap + kHalfStep) - sensor.curve.volts(gap - kHalfStep)).value / (2.0 * kHalfStep.value);
  const double sample_v = std::hypot(kNoiseV, kStepV / std::sqrt(12.0));
  return sample_v / std::sqrt(kWindowScans) / std::abs(slope_v_per_mm);
}

/// Returns the lower bound of the variance of the position, mm^2, for any estimator.
double least_variance_mm2(const RigModel& rig, const InfluenceTable& plate, Point load) {
  const core::Millimetres step{rig.plate.a.value / InfluenceTable::kDefaultDivisions};  // one cell: rows are linear inside it
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < rig.sensors.size(); ++k) {
    const auto at = [&](Point point) { return plate.at_point_mm_per_n(k, point); };
    const double per_newton = at(load);
    const Eigen::Vector3d slope{kLoadN * (at({load.x + step, load.y}) - at({load.x - step, load.y})) / (2.0 * step.value),
                                kLoadN * (at({load.x, load.y + step}) - at({load.x, load.y - step})) / (2.0 * step.value), per_newton};
    const double deviation_mm = noise_mm(rig.sensors[k], kLoadN * per_newton);
    information += slope * slope.transpose() / (deviation_mm * deviation_mm);
  }
  const Eigen::Matrix3d covariance = information.inverse();
  return covariance(0, 0) + covariance(1, 1);
}

core::Result<double> noise_limit_mm(const RigModel& rig) {
  std::vector<Point> sensors;
  for (const physics::SensorModel& sensor : rig.sensors) sensors.push_back(sensor.position);
  DTS_TRY_ASSIGN(const auto plate, InfluenceTable::create(rig.plate, rig.support, sensors));
  double sum_mm2 = 0.0;
  for (int j = 0; j < kPlacementGrid; ++j) {
    for (int i = 0; i < kPlacementGrid; ++i) {
      const auto part = [](int index) { return kMargin + (1.0 - 2.0 * kMargin) * index / (kPlacementGrid - 1); };
      sum_mm2 += least_variance_mm2(rig, plate, {rig.plate.a * part(i), rig.plate.b * part(j)});
    }
  }
  return std::sqrt(sum_mm2 / (kPlacementGrid * kPlacementGrid));
}

/// Returns the noise-free error under random stances.
core::Result<double> foot_error_mm(const RigModel& rig, const physics::CopEstimator& estimator, std::size_t feet,
                                   physics::PlateBehaviour behaviour) {
  const auto trials = physics::foot_trials(rig.plate, feet, kPlacementStances, kPersonN, kPlacementSeed + feet);
  if (trials.empty()) return core::fail(core::ErrorCode::InvalidArgument, "this plate is too small for a foot");
  DTS_TRY_ASSIGN(const auto evaluation, physics::evaluate_cop(rig, estimator, trials, {.behaviour = behaviour}));
  return evaluation.figures.rms_total_mm;
}

/// Returns the rig's plate with another sensor layout.
RigModel with_layout(const RigModel& rig, std::size_t sensor_count, double distance_mm) {
  RigModel tried{.plate = rig.plate, .support = rig.support, .sensors = {}};
  for (const Point& point : sensor_layout(rig.plate, sensor_count, distance_mm)) {
    physics::SensorModel sensor = rig.sensors.front();
    sensor.label = "w" + std::to_string(tried.sensors.size() + 1);
    sensor.position = point;
    tried.sensors.push_back(std::move(sensor));
  }
  return tried;
}

}  // namespace

std::vector<Point> sensor_layout(const physics::Plate& plate, std::size_t sensor_count, double distance_mm) {
  const int per_side = sensor_count == 16 ? 4 : sensor_count == 8 ? 3 : 2;
  std::vector<Point> points;
  for (int j = 0; j < per_side; ++j) {
    for (int i = 0; i < per_side; ++i) {
      const bool is_middle = sensor_count == 8 && i == 1 && j == 1;
      const auto along = [&](core::Millimetres side, int index) {
        return core::Millimetres{distance_mm + (side.value - 2.0 * distance_mm) * index / (per_side - 1)};
      };
      if (!is_middle) points.push_back({along(plate.a, i), along(plate.b, j)});
    }
  }
  return points;
}

core::Result<PlacementFigures> placement_figures(const RigModel& rig_of_plate, std::size_t sensor_count, double distance_mm,
                                                 physics::PlateBehaviour behaviour) {
  const RigModel rig = with_layout(rig_of_plate, sensor_count, distance_mm);
  const auto method = rig.sensors.size() == physics::kFloorSensors ? physics::CopMethod::Poly3 : physics::CopMethod::Moment;
  DTS_TRY_ASSIGN(const auto noise, noise_limit_mm(rig));
  DTS_TRY_ASSIGN(const auto estimator, physics::CopEstimator::from_model(method, rig, behaviour));
  DTS_TRY_ASSIGN(const auto one_foot, foot_error_mm(rig, estimator, 1, behaviour));
  DTS_TRY_ASSIGN(const auto two_feet, foot_error_mm(rig, estimator, 2, behaviour));
  const double stances_mm = std::hypot(one_foot, two_feet) / std::sqrt(2.0);
  return PlacementFigures{.distance_mm = distance_mm,
                          .noise_limit_mm = noise,
                          .one_foot_mm = one_foot,
                          .two_feet_mm = two_feet,
                          .standing_mm = std::hypot(noise, stances_mm)};
}

core::Result<Placement> place_sensors(const RigModel& rig, std::size_t sensor_count, physics::PlateBehaviour behaviour,
                                      const std::function<void(double)>& report_progress) {
  const double last_mm = kLastPart * std::min(rig.plate.a.value, rig.plate.b.value);
  if (last_mm < kFirstMm) return core::fail(core::ErrorCode::InvalidArgument, "the plate is too small for a choice of sensor positions");
  Placement placement;
  const int steps = static_cast<int>((last_mm - kFirstMm) / kStepMm);
  for (int step = 0; step <= steps; ++step) {
    const double distance_mm = kFirstMm + kStepMm * step;
    DTS_TRY_ASSIGN(const auto figures, placement_figures(rig, sensor_count, distance_mm, behaviour));
    placement.rows.push_back(figures);
    report_progress((distance_mm - kFirstMm) / (last_mm - kFirstMm));
  }
  const auto best = [&](double PlacementFigures::*figure) {
    return static_cast<std::size_t>(std::ranges::min_element(placement.rows, {}, figure) - placement.rows.begin());
  };
  placement.best_standing = best(&PlacementFigures::standing_mm);
  placement.best_point_load = best(&PlacementFigures::noise_limit_mm);
  return placement;
}

}  // namespace dts::lab::place
