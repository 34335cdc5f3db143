// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>

#include "physics/cop/cop_estimator.h"
#include "physics/cop/cop_trials.h"

namespace dts::physics {
namespace {

/// Thesis 4.5: 50 kgf.
constexpr std::array<double, 1> kThesisLoadN{490.0};

constexpr Interval kLibraryLoadN{kModelLoadsN.front(), kModelLoadsN.back()};
constexpr std::uint64_t kLibrarySeed = 20;
constexpr std::size_t kStancesPerKind = 300;

core::Status check_floor_sensors(const RigModel& rig) {
  constexpr auto kHint = "a floor platform has four sensors: w1 left back, w2 right back, w3 left front, w4 right front";
  if (rig.sensors.size() != kFloorSensors) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "the rig has " + std::to_string(rig.sensors.size()) + " sensors, this centre-of-pressure method needs 4", kHint);
  }
  const auto centre = SensorRectangle::of(rig).centre();
  for (std::size_t k = 0; k < kFloorSensors; ++k) {
    const SensorModel& sensor = rig.sensors[k];
    const Point& position = sensor.position;
    const bool is_right = k == 1 || k == 3;
    const bool is_front = k >= 2;
    const bool fits =
        (is_right ? position.x > centre.x : position.x < centre.x) && (is_front ? position.y > centre.y : position.y < centre.y);
    if (fits) continue;
    return core::fail(core::ErrorCode::InvalidArgument,
                      "sensor " + std::to_string(k + 1) + " ('" + sensor.label + "') at (" + std::to_string(position.x.value) + ", " +
                          std::to_string(position.y.value) + ") mm is not " + (is_right ? "right" : "left") +
                          (is_front ? " front" : " back") + " of the sensors' centre",
                      kHint);
  }
  return {};
}

core::Status check_sensors(CopMethod method, const RigModel& rig) {
  if (method == CopMethod::Model) return {};
  if (method != CopMethod::Moment) return check_floor_sensors(rig);
  if (rig.sensors.size() > kFloorSensors && rig.sensors.size() <= kMaxCopSensors) return {};
  return core::fail(core::ErrorCode::InvalidArgument,
                    "the rig has " + std::to_string(rig.sensors.size()) + " sensors, moment needs 5 to " + std::to_string(kMaxCopSensors),
                    "use poly3 for four sensors");
}

void append(std::vector<CopTrial>& trials, std::vector<CopTrial> more) {
  trials.insert(trials.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::vector<CopTrial> trials_for(CopMethod method, const RigModel& rig) {
  const auto area = SensorRectangle::of(rig);
  if (method == CopMethod::Poly3) return point_trials(grid_positions(area, 7), kModelLoadsN);
  if (method == CopMethod::Moment) {
    auto trials = point_trials(grid_positions(area, 9), kModelLoadsN);
    append(trials, foot_trials(rig.plate, 1, kStancesPerKind, kLibraryLoadN, kLibrarySeed));
    append(trials, foot_trials(rig.plate, 2, kStancesPerKind, kLibraryLoadN, kLibrarySeed + 1));
    return trials;
  }
  // Thesis 4.4: five points on each mid-line. The even grid has no point on a mid-line, so it is used only for the load.
  auto trials = point_trials(grid_positions(area, 6), kThesisLoadN);
  append(trials, point_trials(mid_line_positions(area), kThesisLoadN));
  return trials;
}

/// Creates an estimator that uses the plate as its own calibration. Thin-plate theory is valid up to a deflection of half the thickness
/// (plate-model section 6); the stiffening is tabulated up to a load that would cause three thicknesses without stiffening.
core::Result<CopEstimator> estimator_of_plate(const RigModel& rig, PlateBehaviour behaviour) {
  const double thicknesses = behaviour == PlateBehaviour::Linear ? 0.5 : 3.0;
  ModelForm form{.behaviour = behaviour, .heaviest = {}, .plate = rig.plate, .support = rig.support, .sensors = {}};
  for (const SensorModel& sensor : rig.sensors) form.sensors.push_back(sensor.position);
  DTS_TRY_ASSIGN(const auto table, InfluenceTable::create(rig.plate, rig.support, form.sensors));
  double largest_mm_per_n = 0.0;
  for (std::size_t k = 0; k < form.sensors.size(); ++k) {
    largest_mm_per_n = std::max(largest_mm_per_n, table.at_point_mm_per_n(k, SensorRectangle::of(rig).centre()));
  }
  form.heaviest = {thicknesses * rig.plate.h.value / largest_mm_per_n};
  const CopValidity validity{.x_mm = {0.0, rig.plate.a.value}, .y_mm = {0.0, rig.plate.b.value}, .load_n = {0.0, form.heaviest.value}};
  return CopEstimator::from_form(CopMethod::Model, std::move(form), validity);
}

}  // namespace

core::Result<std::vector<CopSample>> model_samples(CopMethod method, const RigModel& rig, PlateBehaviour behaviour) {
  DTS_TRY(check_sensors(method, rig));
  DTS_TRY_ASSIGN(const auto plate, SensedPlate::create(rig, behaviour));
  std::vector<CopSample> samples;
  if (method == CopMethod::Model) return samples;
  for (const CopTrial& trial : trials_for(method, rig)) {
    CopSample sample{.load_position = trial.centre, .load = {0.0}, .deflection_mm = plate.deflection_mm(trial.loads)};
    for (const PlateLoad& load : trial.loads) sample.load = sample.load + load.force;
    samples.push_back(std::move(sample));
  }
  return samples;
}

core::Result<CopEstimator> CopEstimator::from_model(CopMethod method, const RigModel& rig, PlateBehaviour behaviour) {
  if (method == CopMethod::Model) return estimator_of_plate(rig, behaviour);
  DTS_TRY_ASSIGN(const auto samples, model_samples(method, rig, behaviour));
  return fit(method, samples);
}

}  // namespace dts::physics
