// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_form_check.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "physics/cop/cop_least_squares.h"

namespace dts::physics {
namespace {

bool is_good(const Interval& range) { return std::isfinite(range.lowest) && std::isfinite(range.highest) && range.lowest <= range.highest; }

template <class Values>
bool are_finite(const Values& values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

bool is_good(const SumPolynomial& polynomial) {
  if (!is_good(polynomial.u) || !is_good(polynomial.v) || !is_good(polynomial.relative_sum)) return false;
  if (!std::isfinite(polynomial.reference_sum_mm) || polynomial.reference_sum_mm <= 0.0) return false;
  if (polynomial.sum_power_count < 1 || polynomial.sum_power_count > SumPolynomial::kMaxSumPowers) return false;
  return std::ranges::all_of(polynomial.by_sum_power, [](const Quintic& quintic) {
    return std::ranges::all_of(quintic.coefficients, are_finite<Quintic::Outputs>);
  });
}

bool is_good(const RatioFit& fit) { return is_good(fit.ratio) && fit.ratio.lowest > 0.0 && are_finite(fit.quartic); }

/// Returns the number of sensors of a valid form; 0 if the form is invalid.
std::size_t sensors_of(const Poly3Form& form, CopMethod) { return is_good(form.polynomial) ? kFloorSensors : 0; }

std::size_t sensors_of(const ThesisForm& form, CopMethod method) {
  const std::size_t ratios = method == CopMethod::ThesisPerPair ? 2 : 1;
  const auto is_good_axis = [ratios](const std::vector<RatioFit>& axis) {
    return axis.size() == ratios && std::ranges::all_of(axis, [](const RatioFit& fit) { return is_good(fit); });
  };
  return is_good_axis(form.x) && is_good_axis(form.y) && is_good(form.load) ? kFloorSensors : 0;
}

std::size_t sensors_of(const MomentForm& form, CopMethod) {
  const std::size_t n = form.load_n_per_mm.size();
  if (n <= kFloorSensors || n > kMaxCopSensors) return 0;
  if (form.x_moment_n.size() != n || form.y_moment_n.size() != n || form.share.size() != n) return 0;
  const std::size_t quadratic = form.x_quadratic_mm.size();
  if (form.y_quadratic_mm.size() != quadratic || (quadratic != 0 && quadratic != n * (n + 1) / 2)) return 0;
  const bool are_good = std::isfinite(form.centre.x.value) && std::isfinite(form.centre.y.value) && are_finite(form.load_n_per_mm) &&
                        are_finite(form.x_moment_n) && are_finite(form.y_moment_n) && are_finite(form.x_quadratic_mm) &&
                        are_finite(form.y_quadratic_mm) &&
                        std::ranges::all_of(form.share, [](const Interval& share) { return is_good(share); });
  return are_good ? n : 0;
}

/// The plate itself is checked by the solver.
std::size_t sensors_of(const ModelForm& form, CopMethod) {
  constexpr std::size_t kUnknowns = 3;
  const std::size_t n = form.sensors.size();
  const bool is_load_good = std::isfinite(form.heaviest.value) && form.heaviest.value > 0.0;
  return n >= kUnknowns && n <= kMaxCopSensors && is_load_good ? n : 0;
}

std::size_t form_of(CopMethod method) {
  switch (method) {
    case CopMethod::Poly3: return 0;
    case CopMethod::Thesis:
    case CopMethod::ThesisPerPair: return 1;
    case CopMethod::Moment: return 2;
    case CopMethod::Model: return 3;
  }
  return std::variant_npos;
}

}  // namespace

core::Result<std::size_t> check_form(CopMethod method, const CopForm& form, const CopValidity& validity) {
  const std::string name(to_string(method));
  if (form.index() != form_of(method)) return refuse_calibration("the coefficients are not those of " + name);
  if (!is_good(validity.x_mm) || !is_good(validity.y_mm)) return refuse_calibration("the calibrated area is empty or not finite");
  if (!is_good(validity.load_n) || validity.load_n.lowest < 0.0) return refuse_calibration("the calibrated load range is not valid");
  const std::size_t sensors = std::visit([method](const auto& one) { return sensors_of(one, method); }, form);
  if (sensors == 0) return refuse_calibration("a number, a range or a count among the coefficients of " + name + " is not valid");
  return sensors;
}

}  // namespace dts::physics
