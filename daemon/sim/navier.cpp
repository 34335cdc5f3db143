// SPDX-License-Identifier: Apache-2.0
#include "sim/navier.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/conversions.h"

namespace dts::sim {
namespace {

constexpr double kPi = std::numbers::pi;

/// Returns the integral of sin(k pi z) over [from, to] within [0, 1].
double sine_integral(int k, double from, double to) noexcept {
  const double wave = k * kPi;
  return (std::cos(wave * std::clamp(from, 0.0, 1.0)) - std::cos(wave * std::clamp(to, 0.0, 1.0))) / wave;
}

}  // namespace

NavierStrip::NavierStrip(const physics::Plate& plate, physics::Point probe, core::Millimetres from_x, core::Millimetres to_x, int terms)
    : depth_mm_(plate.b.value), coefficients_(static_cast<std::size_t>(std::max(terms, 1))) {
  const double a_m = plate.a.value / physics::kMillimetresPerMetre;
  const double b_m = plate.b.value / physics::kMillimetresPerMetre;
  const double rigidity = plate.rigidity_nm() * kPi * kPi * kPi * kPi;
  const int count = static_cast<int>(coefficients_.size());
  for (int m = 1; m <= count; ++m) {
    const double along_x = 4.0 * sine_integral(m, from_x / plate.a, to_x / plate.a) * std::sin(m * kPi * (probe.x / plate.a));
    for (int n = 1; n <= count; ++n) {
      const double waves = m * m / (a_m * a_m) + n * n / (b_m * b_m);
      coefficients_[static_cast<std::size_t>(n - 1)] += along_x / (rigidity * waves * waves);
    }
  }
  for (int n = 1; n <= count; ++n) {
    coefficients_[static_cast<std::size_t>(n - 1)] *= physics::kMillimetresPerMetre * std::sin(n * kPi * (probe.y / plate.b));
  }
}

double NavierStrip::mm_per_pa(core::Millimetres from_y, core::Millimetres to_y) const noexcept {
  double sum = 0.0;
  for (std::size_t n = 0; n < coefficients_.size(); ++n) {
    sum += coefficients_[n] * sine_integral(static_cast<int>(n) + 1, from_y.value / depth_mm_, to_y.value / depth_mm_);
  }
  return sum;
}

double navier_mm_per_n(const physics::Plate& plate, physics::Point probe, const physics::Patch& patch, int terms) {
  const core::Millimetres half_width = patch.width / 2.0;
  const core::Millimetres half_height = patch.height / 2.0;
  const NavierStrip strip(plate, probe, patch.centre.x - half_width, patch.centre.x + half_width, terms);
  const double area_m2 = patch.width.value * patch.height.value / physics::kSquareMillimetresPerSquareMetre;
  return strip.mm_per_pa(patch.centre.y - half_height, patch.centre.y + half_height) / area_m2;
}

}  // namespace dts::sim
