// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_estimator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "physics/cop/cop_features.h"
#include "physics/cop/cop_fit.h"
#include "physics/cop/cop_form_check.h"
#include "physics/cop/cop_inverse.h"
#include "physics/cop/cop_least_squares.h"

namespace dts::physics {
namespace {

/// A fit that misses its own samples by this fraction of the calibrated area has wrong samples.
constexpr double kLargestMisfit = 0.05;

constexpr std::array<std::string_view, 5> kMethodNames{"poly3", "thesis", "thesis_per_pair", "moment", "model"};

/// An estimate before its position and load are compared with the calibration's validity.
struct Raw {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double load_n = 0.0;
  std::uint8_t flags = 0;
};

constexpr std::uint8_t flag_unless(bool is_inside, std::uint8_t flag) noexcept { return is_inside ? std::uint8_t{0} : flag; }

double horner(const std::array<double, 5>& coefficients, double argument) noexcept {
  double value = 0.0;
  for (std::size_t k = coefficients.size(); k-- > 0;) value = value * argument + coefficients[k];
  return value;
}

Raw evaluate(const SumPolynomial& polynomial, std::span<const double> w) noexcept {
  const auto [sum, u, v] = FloorFeatures::of(w);
  const double clamped_u = polynomial.u.clamp(u);
  const double clamped_v = polynomial.v.clamp(v);
  const double relative_sum = sum / polynomial.reference_sum_mm;
  auto outputs = polynomial.by_sum_power[0](clamped_u, clamped_v);
  double power = 1.0;
  for (std::size_t k = 1; k < polynomial.sum_power_count; ++k) {
    power *= polynomial.relative_sum.clamp(relative_sum);
    const auto more = polynomial.by_sum_power[k](clamped_u, clamped_v);
    for (std::size_t output = 0; output < outputs.size(); ++output) outputs[output] += power * more[output];
  }
  const bool knows_sum = polynomial.sum_power_count == 1 || polynomial.relative_sum.contains(relative_sum);
  const auto flags = static_cast<std::uint8_t>(flag_unless(polynomial.u.contains(u) && polynomial.v.contains(v), cop_flag::kOutsideArea) |
                                               flag_unless(knows_sum, cop_flag::kOutsideLoad));
  return {outputs[0], outputs[1], outputs[2] > 0.0 ? sum / outputs[2] : std::numeric_limits<double>::quiet_NaN(), flags};
}

/// Returns the mean over the axis's ratios; adds to `flags`.
double position(std::span<const RatioFit> fits, std::span<const RatioOf> ratios, std::span<const double> w, std::uint8_t& flags) noexcept {
  double sum_mm = 0.0;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const double ratio = ratios[k](w);
    sum_mm += horner(fits[k].quartic, fits[k].ratio.clamp(ratio) - 1.0);
    flags = static_cast<std::uint8_t>(flags | flag_unless(fits[k].ratio.contains(ratio), cop_flag::kOutsideArea));
  }
  return sum_mm / static_cast<double>(fits.size());
}

Raw evaluate(const ThesisForm& form, CopMethod method, std::span<const double> w) noexcept {
  Raw raw = evaluate(form.load, w);
  const ThesisRatios& ratios = ratios_of(method);
  raw.x_mm = position(form.x, ratios.x, w, raw.flags);
  raw.y_mm = position(form.y, ratios.y, w, raw.flags);
  return raw;
}

Raw evaluate(const MomentForm& form, std::span<const double> w, double sum) noexcept {
  Raw raw;
  std::array<double, kMaxCopSensors> shares;
  double clamped_sum = 0.0;
  for (std::size_t k = 0; k < w.size(); ++k) {
    raw.load_n += form.load_n_per_mm[k] * w[k];
    const double share = w[k] / sum;
    shares[k] = form.share[k].clamp(share);
    clamped_sum += shares[k];
    raw.flags = static_cast<std::uint8_t>(raw.flags | flag_unless(form.share[k].contains(share), cop_flag::kOutsideArea));
  }
  double x_mm = 0.0;
  double y_mm = 0.0;
  if (form.x_quadratic_mm.empty()) {
    double load = 0.0;
    for (std::size_t k = 0; k < w.size(); ++k) {
      load += form.load_n_per_mm[k] * shares[k];
      x_mm += form.x_moment_n[k] * shares[k];
      y_mm += form.y_moment_n[k] * shares[k];
    }
    x_mm /= load;
    y_mm /= load;
  } else {
    std::size_t term = 0;
    for (std::size_t i = 0; i < w.size(); ++i) {
      for (std::size_t j = i; j < w.size(); ++j, ++term) {
        const double product = shares[i] * shares[j] / (clamped_sum * clamped_sum);
        x_mm += form.x_quadratic_mm[term] * product;
        y_mm += form.y_quadratic_mm[term] * product;
      }
    }
  }
  raw.x_mm = form.centre.x.value + x_mm;
  raw.y_mm = form.centre.y.value + y_mm;
  return raw;
}

}  // namespace

const ThesisRatios& ratios_of(CopMethod method) noexcept {
  using W = std::span<const double>;
  static constexpr std::array<RatioOf, 1> kAverageX{[](W w) { return deflection_ratio(w[0] + w[2], w[1] + w[3]); }};
  static constexpr std::array<RatioOf, 1> kAverageY{[](W w) { return deflection_ratio(w[0] + w[1], w[2] + w[3]); }};
  static constexpr std::array<RatioOf, 2> kPairsX{[](W w) { return deflection_ratio(w[0], w[1]); },
                                                  [](W w) { return deflection_ratio(w[2], w[3]); }};
  static constexpr std::array<RatioOf, 2> kPairsY{[](W w) { return deflection_ratio(w[0], w[2]); },
                                                  [](W w) { return deflection_ratio(w[1], w[3]); }};
  static constexpr ThesisRatios kAverages{kAverageX, kAverageY};
  static constexpr ThesisRatios kPairs{kPairsX, kPairsY};
  return method == CopMethod::ThesisPerPair ? kPairs : kAverages;
}

core::Result<CopMethod> parse_cop_method(std::string_view name) {
  const auto found = std::ranges::find(kMethodNames, name);
  if (found != kMethodNames.end()) return static_cast<CopMethod>(found - kMethodNames.begin());
  return core::fail(core::ErrorCode::InvalidArgument, "unknown centre-of-pressure method '" + std::string(name) + "'",
                    "use poly3, thesis, thesis_per_pair, moment or model");
}

std::string_view to_string(CopMethod method) noexcept { return kMethodNames[static_cast<std::size_t>(method)]; }

std::string cop_flags_text(std::uint8_t flags) {
  std::string text;
  for (const auto& [flag, word] :
       {std::pair{cop_flag::kNoContact, "no_contact"}, std::pair{cop_flag::kOutsideArea, "outside_area"},
        std::pair{cop_flag::kOutsideLoad, "outside_load"}, std::pair{cop_flag::kOutsideTwoFeet, "outside_two_feet"},
        std::pair{cop_flag::kOutsideTravel, "outside_travel"}, std::pair{cop_flag::kAbout, "about"},
        std::pair{cop_flag::kDoubtful, "doubtful"}}) {
    if ((flags & flag) != 0) text += (text.empty() ? "" : "|") + std::string(word);
  }
  return text;
}

core::Result<CopEstimator> CopEstimator::from_form(CopMethod method, CopForm form, CopValidity validity) {
  DTS_TRY_ASSIGN(const auto sensor_count, check_form(method, form, validity));
  CopEstimator estimator;
  estimator.method_ = method;
  estimator.sensor_count_ = sensor_count;
  estimator.form_ = std::move(form);
  estimator.validity_ = validity;
  if (const auto* const model = std::get_if<ModelForm>(&estimator.form_)) {
    DTS_TRY_ASSIGN(estimator.inverse_, CopInverse::create(*model));
  }
  return estimator;
}

core::Result<CopEstimator> CopEstimator::fit(CopMethod method, std::span<const CopSample> samples) {
  DTS_TRY_ASSIGN(auto fitted, fit_cop(method, samples));
  return accept(method, std::move(fitted), samples);
}

core::Result<CopEstimator> accept(CopMethod method, CopFit fitted, std::span<const CopSample> samples) {
  DTS_TRY_ASSIGN(auto estimator, CopEstimator::from_form(method, std::move(fitted.form), fitted.validity));
  double squares = 0.0;
  for (const auto& sample : samples) {
    const auto estimate = estimator.estimate(sample.deflection_mm);
    squares += std::pow(estimate.x_mm - sample.load_position.x.value, 2) + std::pow(estimate.y_mm - sample.load_position.y.value, 2);
  }
  const double misfit_mm = std::sqrt(squares / static_cast<double>(samples.size()));
  const auto& [x_mm, y_mm, load_n] = estimator.validity();
  if (misfit_mm <= kLargestMisfit * std::min(x_mm.highest - x_mm.lowest, y_mm.highest - y_mm.lowest)) return estimator;
  return refuse_calibration("the result misses its own samples by " + std::to_string(misfit_mm) + " mm rms", kSensorOrderHint);
}

CopEstimate CopEstimator::estimate(std::span<const double> deflection_mm) const noexcept {
  if (deflection_mm.size() != sensor_count_) return {};
  double sum = 0.0;
  for (const double w : deflection_mm) sum += w;
  if (!(sum > 0.0 && sum <= std::numeric_limits<double>::max())) return {};
  Raw raw;
  if (const auto* const poly3 = std::get_if<Poly3Form>(&form_)) {
    raw = evaluate(poly3->polynomial, deflection_mm);
  } else if (const auto* const thesis = std::get_if<ThesisForm>(&form_)) {
    raw = evaluate(*thesis, method_, deflection_mm);
  } else if (const auto* const moment = std::get_if<MomentForm>(&form_)) {
    raw = evaluate(*moment, deflection_mm, sum);
  } else {
    const auto found = inverse_->solve(deflection_mm);
    raw = {found.x_mm, found.y_mm, found.load_n, 0};
  }
  const bool is_load = raw.load_n > 0.0 && std::isfinite(raw.load_n);
  if (!std::isfinite(raw.x_mm) || !std::isfinite(raw.y_mm) || !is_load) return {};  // no force can cause such deflections
  const bool is_inside_area = validity_.x_mm.contains(raw.x_mm) && validity_.y_mm.contains(raw.y_mm);
  return {.x_mm = validity_.x_mm.clamp(raw.x_mm),
          .y_mm = validity_.y_mm.clamp(raw.y_mm),
          .load_n = raw.load_n,
          .flags = static_cast<std::uint8_t>(raw.flags | flag_unless(is_inside_area, cop_flag::kOutsideArea) |
                                             flag_unless(validity_.load_n.contains(raw.load_n), cop_flag::kOutsideLoad))};
}

}  // namespace dts::physics
