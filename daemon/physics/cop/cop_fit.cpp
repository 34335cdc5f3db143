// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_fit.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "physics/cop/cop_least_squares.h"

namespace dts::physics {
namespace {

/// Calibrations have hundreds of samples; a larger number means single scans that should have been averaged.
constexpr std::size_t kMaxSamples = 10'000;

core::Status check_sample(const CopSample& sample, const std::string& name) {
  const auto& [position, load, w] = sample;
  const bool is_finite = std::isfinite(position.x.value) && std::isfinite(position.y.value) && std::isfinite(load.value) &&
                         std::ranges::all_of(w, [](double value) { return std::isfinite(value); });
  if (!is_finite) return refuse_calibration(name + " has a value that is not finite");
  if (!(load.value > 0.0))
    return refuse_calibration("the load of " + name + " is " + std::to_string(load.value) + " N; it must be positive");
  const bool presses_each_pair =
      w.size() == kFloorSensors ? w[0] + w[2] > 0.0 && w[1] + w[3] > 0.0 && w[0] + w[1] > 0.0 && w[2] + w[3] > 0.0 : sum_of(sample) > 0.0;
  if (presses_each_pair) return {};
  return refuse_calibration(name + " does not press every pair of sensors down",
                            "check the signs: deflections towards the sensors are positive");
}

core::Status check_sensor_count(CopMethod method, std::size_t count) {
  const std::string what = std::string(to_string(method)) + " needs ";
  if (method == CopMethod::Moment && (count <= kFloorSensors || count > kMaxCopSensors)) {
    return refuse_calibration(what + "5 to " + std::to_string(kMaxCopSensors) + " sensors, the samples have " + std::to_string(count),
                              "use poly3 for four sensors");
  }
  if (method != CopMethod::Moment && count != kFloorSensors) {
    return refuse_calibration(what + "4 sensors, the samples have " + std::to_string(count), "use moment for more than four sensors");
  }
  return {};
}

core::Status check_samples(CopMethod method, std::span<const CopSample> samples) {
  if (method == CopMethod::Model) {
    return refuse_calibration("the method model has no coefficients to fit", "it uses the rig's plate model: choose another method");
  }
  if (samples.empty()) return refuse_calibration("there are no samples");
  if (samples.size() > kMaxSamples) {
    return refuse_calibration(std::to_string(samples.size()) + " samples, at most " + std::to_string(kMaxSamples) + " are allowed",
                              "average the scans of each position");
  }
  const std::size_t sensor_count = samples.front().deflection_mm.size();
  DTS_TRY(check_sensor_count(method, sensor_count));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const std::string name = "sample " + std::to_string(k);
    if (samples[k].deflection_mm.size() != sensor_count) {
      return refuse_calibration(name + " has " + std::to_string(samples[k].deflection_mm.size()) + " deflections, the first one " +
                                std::to_string(sensor_count));
    }
    DTS_TRY(check_sample(samples[k], name));
  }
  return {};
}

CopValidity validity_of(std::span<const CopSample> samples) {
  const auto load_of = [](const CopSample& sample) { return sample.load.value; };
  const auto [lightest, heaviest] = std::ranges::minmax(samples, {}, load_of);
  return {.x_mm = calibrated_range(samples, [](const CopSample& sample) { return sample.load_position.x.value; }),
          .y_mm = calibrated_range(samples, [](const CopSample& sample) { return sample.load_position.y.value; }),
          .load_n = {lightest.load.value * (1.0 - kCopLoadMargin), heaviest.load.value * (1.0 + kCopLoadMargin)}};
}

}  // namespace

double sum_of(const CopSample& sample) noexcept {
  double sum = 0.0;
  for (const double w : sample.deflection_mm) sum += w;
  return sum;
}

core::Result<CopFit> fit_cop(CopMethod method, std::span<const CopSample> samples) {
  DTS_TRY(check_samples(method, samples));
  const CopValidity validity = validity_of(samples);
  return method == CopMethod::Moment ? fit_moment(samples, validity) : fit_floor(method, samples, validity);
}

}  // namespace dts::physics
