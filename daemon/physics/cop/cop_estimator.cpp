// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_estimator.h"

#include <limits>
#include <string>
#include <vector>

namespace dts::physics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Thesis 4.5: 50 kgf.
constexpr core::Newtons kModelLoad{490.0};

template <std::size_t Size>
double horner(const std::array<double, Size>& coefficients, double argument) noexcept {
  double value = 0.0;
  for (std::size_t k = Size; k-- > 0;) value = value * argument + coefficients[k];
  return value;
}

/// `count` evenly spaced values from `first` to `last`.
std::vector<core::Millimetres> evenly(core::Millimetres first, core::Millimetres last, int count) {
  std::vector<core::Millimetres> values;
  values.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) values.push_back(first + (last - first) * (static_cast<double>(k) / (count - 1)));
  return values;
}

/// The rectangle between the sensors; their sides need not be exactly parallel to the plate's.
struct SensorSquare {
  core::Millimetres left, right, bottom, top;

  [[nodiscard]] static SensorSquare of(const std::vector<SensorModel>& w) {
    return {(w[0].position.x + w[2].position.x) / 2, (w[1].position.x + w[3].position.x) / 2, (w[0].position.y + w[1].position.y) / 2,
            (w[2].position.y + w[3].position.y) / 2};
  }
  [[nodiscard]] Point centre() const { return {(left + right) / 2, (bottom + top) / 2}; }
};

std::vector<Point> grid(const SensorSquare& square, int count) {
  std::vector<Point> points;
  for (const auto y : evenly(square.bottom, square.top, count)) {
    for (const auto x : evenly(square.left, square.right, count)) points.push_back({x, y});
  }
  return points;
}

std::vector<Point> calibration_points(CopMethod method, const SensorSquare& square) {
  if (method == CopMethod::Poly3) return grid(square, 7);
  // Thesis 4.4: five points on each mid-line. The even grid has no point on a mid-line, so that it serves the load only.
  auto points = grid(square, 6);
  for (const auto x : evenly(square.left, square.right, 5)) points.push_back({x, square.centre().y});
  for (const auto y : evenly(square.bottom, square.top, 5)) points.push_back({square.centre().x, y});
  return points;
}

core::Status check_sensor_order(const RigModel& rig) {
  constexpr auto kHint = "a floor platform has four sensors: w1 left back, w2 right back, w3 left front, w4 right front";
  if (rig.sensors.size() != kFloorSensors) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "the rig has " + std::to_string(rig.sensors.size()) + " sensors, the centre of pressure needs 4", kHint);
  }
  const auto centre = SensorSquare::of(rig.sensors).centre();
  for (std::size_t k = 0; k < kFloorSensors; ++k) {
    const auto& [label, position, curve, unloaded_gap] = rig.sensors[k];
    const bool is_right = k == 1 || k == 3;
    const bool is_front = k >= 2;
    const bool fits =
        (is_right ? position.x > centre.x : position.x < centre.x) && (is_front ? position.y > centre.y : position.y < centre.y);
    if (fits) continue;
    return core::fail(core::ErrorCode::InvalidArgument,
                      "sensor " + std::to_string(k + 1) + " ('" + label + "') at (" + std::to_string(position.x.value) + ", " +
                          std::to_string(position.y.value) + ") mm is not " + (is_right ? "right" : "left") +
                          (is_front ? " front" : " back") + " of the sensors' centre",
                      kHint);
  }
  return {};
}

}  // namespace

core::Result<CopMethod> parse_cop_method(std::string_view name) {
  if (name == "thesis") return CopMethod::Thesis;
  if (name == "poly3") return CopMethod::Poly3;
  return core::fail(core::ErrorCode::InvalidArgument, "no centre-of-pressure method '" + std::string(name) + "'", "use thesis or poly3");
}

core::Result<CopEstimator> CopEstimator::from_model(CopMethod method, const RigModel& rig) {
  if (const auto status = check_sensor_order(rig); !status) return tl::make_unexpected(status.error());
  std::vector<Point> probes;
  for (const auto& sensor : rig.sensors) probes.push_back(sensor.position);
  const auto table = InfluenceTable::create(rig.plate, rig.support, probes);
  if (!table) return tl::make_unexpected(table.error());
  std::vector<CopSample> samples;
  for (const Point& point : calibration_points(method, SensorSquare::of(rig.sensors))) {
    CopSample sample{.load_position = point, .load = kModelLoad};
    for (std::size_t k = 0; k < kFloorSensors; ++k) sample.deflection_mm[k] = kModelLoad.value * table->at_point_mm_per_n(k, point);
    samples.push_back(sample);
  }
  return fit(method, samples);
}

CopEstimate CopEstimator::estimate(const std::array<double, kFloorSensors>& deflection_mm) const noexcept {
  const auto& [w1, w2, w3, w4] = deflection_mm;
  const double left = w1 + w3;
  const double right = w2 + w4;
  const double back = w1 + w2;
  const double front = w3 + w4;
  const double sum = left + right;
  if (!(sum > 0.0 && sum <= std::numeric_limits<double>::max())) return {kNan, kNan, kNan, false};

  const double u = (right - left) / sum;
  const double v = (front - back) / sum;
  bool is_inside = u_.contains(u) && v_.contains(v);
  auto [x_mm, y_mm, mm_per_n, unused] = polynomial_(u_.clamp(u), v_.clamp(v));
  if (uses_sum_) {
    const double relative_sum = sum / reference_sum_mm_;
    const double factor = relative_sum_.clamp(relative_sum);
    const auto [more_x_mm, more_y_mm, more_mm_per_n, also_unused] = sum_polynomial_(u_.clamp(u), v_.clamp(v));
    x_mm += factor * more_x_mm;
    y_mm += factor * more_y_mm;
    mm_per_n += factor * more_mm_per_n;
    is_inside = is_inside && relative_sum_.contains(relative_sum);
  }
  if (method_ == CopMethod::Thesis) {
    // A pair that is not pressed at all: the load lies at the far side of the other pair.
    const double x_ratio = right > 0.0 ? left / right : std::numeric_limits<double>::infinity();
    const double y_ratio = front > 0.0 ? back / front : std::numeric_limits<double>::infinity();
    x_mm = horner(x_quartic_, x_ratio_.clamp(x_ratio) - 1.0);
    y_mm = horner(y_quartic_, y_ratio_.clamp(y_ratio) - 1.0);
    is_inside = is_inside && x_ratio_.contains(x_ratio) && y_ratio_.contains(y_ratio);
  }
  const double load_n = mm_per_n > 0.0 ? sum / mm_per_n : kNan;
  return {x_mm, y_mm, load_n, is_inside && x_mm_.contains(x_mm) && y_mm_.contains(y_mm)};
}

}  // namespace dts::physics
