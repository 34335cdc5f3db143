// SPDX-License-Identifier: Apache-2.0
// Sensor curves. A curve that is accepted gives finite numbers, leads from gap to volts and back, and is the same when written and read.
#include <cmath>
#include <vector>

#include "files/sensor_curve_file.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::sensor_curve {
namespace {


constexpr double kRoundTripMm = 1e-4;  // what physics/sensor_curve.h says
constexpr int kSteps = 997;            // prime: does not fall together with the steps of any table

std::optional<files::SensorCurveFile> read(const std::string& text, files::Problems& problems) {
  const auto table = files::parse_toml_text(text, "curve.toml", problems);
  if (!table) return std::nullopt;
  files::TomlReader reader(&*table, "", "curve.toml", problems);
  return files::read_sensor_curve(reader, problems);
}

std::vector<physics::CurvePoint> points_of(const std::string& text) {
  files::Problems ignored;
  std::vector<physics::CurvePoint> points;
  const auto table = files::parse_toml_text(text, "curve.toml", ignored);
  files::TomlReader reader(&*table, "", "curve.toml", ignored);
  for (files::TomlReader& point : reader.tables("point")) {
    points.push_back({.gap = {point.number("gap_mm", 0.0, 0.0, 1000.0)}, .volts = {point.number("volts", 0.0, -100.0, 100.0)}});
  }
  return points;
}

core::Millimetres gap_at(const physics::SensorCurve& curve, int step) {
  const double part = static_cast<double>(step) / kSteps;
  return {curve.minimum_gap().value + part * (curve.maximum_gap().value - curve.minimum_gap().value)};
}

void check_values(const physics::SensorCurve& curve) {
  promise(curve.minimum_gap().value < curve.maximum_gap().value, "a curve has a range");
  for (int step = 0; step <= kSteps; ++step) {
    const core::Millimetres gap = gap_at(curve, step);
    const core::Volts volts = curve.volts(gap);
    promise(std::isfinite(volts.value), "volts are finite");
    promise(std::abs(curve.gap(volts).value - gap.value) <= kRoundTripMm * 1.0001, "from gap to volts and back");
  }
  for (const double volts : {-1e300, -1.0, 0.0, 1.0, 1e300}) {
    const double gap_mm = curve.gap({volts}).value;
    promise(gap_mm >= curve.minimum_gap().value && gap_mm <= curve.maximum_gap().value, "any voltage means a gap of the curve");
  }
}

void check_text(const std::string& text, const files::SensorCurveFile& file) {
  files::Problems problems;
  const auto again = read(
      files::sensor_curve_text(file.curve.name(), points_of(text), file.calibration.value_or(files::SensorCalibrationFacts{})), problems);
  promise(again.has_value() && problems.empty(), "what was written can be read");
  for (int step = 0; step <= kSteps; ++step) {
    const core::Millimetres gap = gap_at(file.curve, step);
    promise(again->curve.volts(gap).value == file.curve.volts(gap).value, "the curve read is the one written, bit for bit");
  }
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  const std::string text = fuzz::text_of(bytes, size);
  files::Problems problems;
  const auto file = read(text, problems);
  promise(file.has_value() == problems.empty(), "a curve, or what is wrong with it");
  if (!file) return;
  check_values(file->curve);
  check_text(text, *file);
}

}  // namespace dts::fuzz::sensor_curve

DTS_FUZZ_TARGET(sensor_curve)
