// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/two_feet.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "physics/cop/cop_least_squares.h"

namespace dts::physics {
namespace {

/// No stance is farther from the mean of its feature, in standard deviations: keeps every product finite.
constexpr double kFarthest = 100.0;
constexpr double kLargestLogLoad = 5.0;  // beyond it a factor of the load is nonsense, and its exponential could overflow

bool is_good(const TwoFeetPolynomial::Feature& feature) {
  const auto& [lowest, highest] = feature.range;
  const auto is_near = [&feature](double value) { return std::abs(value - feature.mean) <= kFarthest * feature.sd; };  // not for NaN
  return std::isfinite(feature.mean) && std::isfinite(feature.sd) && feature.sd > 0.0 && lowest <= highest && is_near(lowest) &&
         is_near(highest);
}

bool is_good(const TwoFeetPolynomial& polynomial, std::size_t feature_count) {
  const auto are_finite = [](const auto& values) { return std::ranges::all_of(values, [](double value) { return std::isfinite(value); }); };
  return polynomial.feature_count == feature_count &&
         std::all_of(polynomial.features.begin(), polynomial.features.begin() + static_cast<std::ptrdiff_t>(feature_count),
                     [](const TwoFeetPolynomial::Feature& feature) { return is_good(feature); }) &&
         are_finite(polynomial.x_mm) && are_finite(polynomial.y_mm) && are_finite(polynomial.log_load);
}

}  // namespace

std::array<double, TwoFeetPolynomial::kTermCount> TwoFeetPolynomial::terms_of(const std::array<double, kMaxFeatures>& arguments,
                                                                              std::size_t feature_count) noexcept {
  const std::size_t most = degree(feature_count);
  std::array<std::array<double, kMaxDegree + 1>, kMaxFeatures> power{};
  for (std::size_t f = 0; f < kMaxFeatures; ++f) {
    power[f][0] = 1.0;
    for (std::size_t k = 1; k <= most; ++k) power[f][k] = power[f][k - 1] * arguments[f];
  }
  std::array<double, kTermCount> terms{};
  std::size_t next = 0;
  for (std::size_t i = 0; i <= most; ++i) {
    for (std::size_t j = 0; i + j <= most; ++j) {
      for (std::size_t k = 0; i + j + k <= most; ++k) {
        const double product = power[0][i] * power[1][j] * power[2][k];
        const std::size_t rest = feature_count == kMaxFeatures ? most - i - j - k : 0;
        for (std::size_t l = 0; l <= rest; ++l) terms[next++] = product * power[3][l];
      }
    }
  }
  return terms;
}

core::Result<TwoFeetCorrection> TwoFeetCorrection::from_form(const TwoFeetForm& form) {
  if (!is_good(form.with_width, TwoFeetPolynomial::kMaxFeatures) || !is_good(form.without_width, TwoFeetPolynomial::kMaxFeatures - 1)) {
    return refuse_calibration("a number, a range or a count of the correction for two feet is not valid");
  }
  if (!std::isfinite(form.travel_mm) || form.travel_mm <= 0.0) return refuse_calibration("the travel of the sensors must be positive");
  return TwoFeetCorrection(form);
}

CopEstimate TwoFeetCorrection::apply(const CopEstimate& point, std::span<const double> deflection_mm,
                                     std::optional<double> width_mm) const noexcept {
  if ((point.flags & cop_flag::kNoContact) != 0) return point;
  const TwoFeetPolynomial& polynomial = width_mm ? form_.with_width : form_.without_width;
  const std::array<double, TwoFeetPolynomial::kMaxFeatures> values{point.x_mm, point.y_mm, point.load_n, width_mm.value_or(0.0)};
  std::array<double, TwoFeetPolynomial::kMaxFeatures> arguments{};
  CopEstimate corrected = point;
  const auto set_flag = [&corrected](std::uint8_t flag) { corrected.flags = static_cast<std::uint8_t>(corrected.flags | flag); };
  if (!width_mm) set_flag(cop_flag::kAbout);
  for (std::size_t f = 0; f < polynomial.feature_count; ++f) {
    const auto& [mean, sd, range] = polynomial.features[f];
    if (!range.contains(values[f])) set_flag(cop_flag::kOutsideTwoFeet);
    arguments[f] = (range.clamp(values[f]) - mean) / sd;
  }
  const auto terms = TwoFeetPolynomial::terms_of(arguments, polynomial.feature_count);
  double log_load = 0.0;
  for (std::size_t k = 0; k < terms.size(); ++k) {
    corrected.x_mm += terms[k] * polynomial.x_mm[k];
    corrected.y_mm += terms[k] * polynomial.y_mm[k];
    log_load += terms[k] * polynomial.log_load[k];
  }
  corrected.load_n *= std::exp(std::clamp(log_load, -kLargestLogLoad, kLargestLogLoad));
  if (std::ranges::any_of(deflection_mm, [this](double w) { return w > form_.travel_mm; })) set_flag(cop_flag::kOutsideTravel);
  return corrected;
}

bool TwoFeetCorrection::covers_position(const CopEstimate& point) const noexcept {
  const auto& features = form_.without_width.features;
  return features[0].range.contains(point.x_mm) && features[1].range.contains(point.y_mm);
}

bool is_load_doubtful(double measured_n, double stated_n) noexcept {
  return std::abs(measured_n - stated_n) > kDoubtfulLoadPart * stated_n;
}

}  // namespace dts::physics
