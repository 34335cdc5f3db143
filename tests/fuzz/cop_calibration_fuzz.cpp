// SPDX-License-Identifier: Apache-2.0
// Calibrations of the centre of pressure. One that is accepted is the same when written and read, and its estimates are finite and inside
// the area that it is valid for, or said not to be.
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "files/cop_calibration_file.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::cop_calibration {
namespace {

std::optional<physics::CopCalibration> read(const std::string& text, files::Problems& problems) {
  const auto table = files::parse_toml_text(text, "cop.toml", problems);
  if (!table) return std::nullopt;
  files::TomlReader reader(&*table, "", "cop.toml", problems);
  return files::read_cop_calibration(reader, problems);
}

bool is_inside(double value, const physics::Interval& range) {
  const double margin = 0.011 * (range.highest - range.lowest);  // 1 % for noise, see CopEstimator::estimate
  return value >= range.lowest - margin && value <= range.highest + margin;
}

void check_estimate(const physics::CopEstimator& estimator, const std::vector<double>& deflection_mm) {
  const physics::CopEstimate estimate = estimator.estimate(deflection_mm);
  if ((estimate.flags & physics::cop_flag::kNoContact) != 0) {
    promise(std::isnan(estimate.x_mm) && std::isnan(estimate.y_mm) && std::isnan(estimate.load_n), "without contact there are no numbers");
    return;
  }
  promise(std::isfinite(estimate.x_mm) && std::isfinite(estimate.y_mm) && std::isfinite(estimate.load_n), "an estimate is finite");
  promise(is_inside(estimate.x_mm, estimator.validity().x_mm) && is_inside(estimate.y_mm, estimator.validity().y_mm),
          "a position is clamped to the calibrated area");
}

void check_estimates(const physics::CopEstimator& estimator) {
  for (const double size_mm : {0.0, 1e-300, 1e-6, 0.1, 1.0, 1e3, 1e300, -1.0}) {
    std::vector<double> deflection_mm(estimator.sensor_count(), size_mm);
    check_estimate(estimator, deflection_mm);
    for (double& one : deflection_mm) {
      for (const double other : {0.0, size_mm / 2.0, 2.0 * size_mm, -size_mm, HUGE_VAL, std::nan("")}) {
        const double before = std::exchange(one, other);
        check_estimate(estimator, deflection_mm);
        one = before;
      }
    }
  }
  check_estimate(estimator, {});
}

void check_correction(const physics::TwoFeetCorrection& two_feet) {
  const std::vector<double> deflection_mm(4, 1.0);
  for (const double size : {1e-6, 1.0, 215.0, 1e3, 1e6}) {
    for (const std::optional<double> width_mm :
         {std::optional<double>(), std::optional(-size), std::optional(size), std::optional(1e300)}) {
      const auto corrected = two_feet.apply({.x_mm = size, .y_mm = -size, .load_n = size, .flags = 0}, deflection_mm, width_mm);
      promise(!std::isnan(corrected.x_mm) && !std::isnan(corrected.y_mm), "a corrected position is a number");
      promise(std::isfinite(corrected.load_n) && corrected.load_n > 0.0, "a corrected load is finite and positive");
    }
  }
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  files::Problems problems;
  const auto calibration = read(fuzz::text_of(bytes, size), problems);
  promise(calibration.has_value() == problems.empty(), "a calibration, or what is wrong with it");
  if (!calibration) return;
  const std::string text = files::cop_calibration_text(*calibration);
  const auto again = read(text, problems);
  promise(again.has_value(), "what was written can be read");
  promise(files::cop_calibration_text(*again) == text, "the calibration read is the one written");
  check_estimates(again->estimator);
  if (again->two_feet) check_correction(*again->two_feet);
}

}  // namespace dts::fuzz::cop_calibration

DTS_FUZZ_TARGET(cop_calibration)
