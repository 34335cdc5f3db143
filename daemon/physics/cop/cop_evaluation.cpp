// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_evaluation.h"

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>

namespace dts::physics {
namespace {

constexpr double kNoiseV = 0.003;
/// Thesis 4.3.2: 11 bit over +-5 V.
constexpr double kStepV = 10.0 / 2048.0;
/// Thesis 4.5.
constexpr int kWindowScans = 3;
constexpr int kBaselineScans = 100;

/// Our own Box-Muller, because each library implements std::normal_distribution differently.
class Gaussian {
 public:
  explicit Gaussian(std::uint64_t seed) : random_(seed) {}
  double operator()() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  std::mt19937_64 random_;
};

/// The sensor chain of CopNoise::Realistic.
class NoisySensors {
 public:
  NoisySensors(const RigModel& rig, std::uint64_t seed) : sensors_(rig.sensors), gaussian_(seed) {
    for (const SensorModel& sensor : sensors_) baseline_.push_back(measured_gap(sensor, sensor.unloaded_gap, kBaselineScans));
  }

  void measure(std::span<double> deflection_mm) {
    for (std::size_t k = 0; k < deflection_mm.size(); ++k) {
      const core::Millimetres gap = sensors_[k].unloaded_gap - core::Millimetres{deflection_mm[k]};
      deflection_mm[k] = (baseline_[k] - measured_gap(sensors_[k], gap, kWindowScans)).value;
    }
  }

 private:
  core::Millimetres measured_gap(const SensorModel& sensor, core::Millimetres gap, int scans) {
    double sum_v = 0.0;
    for (int scan = 0; scan < scans; ++scan) {
      sum_v += kStepV * std::round((sensor.curve.volts(gap).value + kNoiseV * gaussian_()) / kStepV);
    }
    return sensor.curve.gap({sum_v / scans});
  }

  const std::vector<SensorModel>& sensors_;
  Gaussian gaussian_;
  std::vector<core::Millimetres> baseline_;
};

}  // namespace

core::Result<CopNoise> parse_cop_noise(std::string_view name) {
  if (name == "none") return CopNoise::None;
  if (name == "realistic") return CopNoise::Realistic;
  return core::fail(core::ErrorCode::InvalidArgument, "unknown sensor noise '" + std::string(name) + "'", "use none or realistic");
}

core::Result<CopEvaluation> evaluate_cop(const RigModel& rig, const CopEstimator& estimator, std::span<const CopTrial> trials,
                                         const CopEvaluationOptions& options) {
  if (rig.sensors.size() != estimator.sensor_count()) {
    return core::fail(
        core::ErrorCode::InvalidArgument,
        "the estimator is for " + std::to_string(estimator.sensor_count()) + " sensors, the rig has " + std::to_string(rig.sensors.size()),
        "evaluate it on the rig it was made for");
  }
  DTS_TRY_ASSIGN(const auto plate, SensedPlate::create(rig, options.behaviour, options.divisions));
  NoisySensors sensors(rig, options.seed);
  CopEvaluation evaluation;
  std::vector<CopCalibrationPoint> counted;
  for (const CopTrial& trial : trials) {
    CopSample sample{.load_position = trial.centre, .load = {0.0}, .deflection_mm = plate.deflection_mm(trial.loads)};
    for (const PlateLoad& load : trial.loads) sample.load = sample.load + load.force;
    if (options.noise == CopNoise::Realistic) sensors.measure(sample.deflection_mm);
    const CopEstimate estimate = estimator.estimate(sample.deflection_mm);
    evaluation.trials.push_back({.point = compare(sample, estimate), .estimate = estimate});
    if ((estimate.flags & cop_flag::kNoContact) != 0) {
      ++evaluation.no_contact_count;
      continue;
    }
    if (!estimate.is_inside_calibration()) ++evaluation.outside_count;
    counted.push_back(evaluation.trials.back().point);
  }
  evaluation.figures = error_figures(counted);
  return evaluation;
}

}  // namespace dts::physics
