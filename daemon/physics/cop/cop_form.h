// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <tuple>
#include <variant>
#include <vector>

#include "core/units.h"
#include "physics/cop/quintic.h"
#include "physics/cop/sensed_plate.h"
#include "physics/plate/plate.h"
#include "physics/rig_model.h"

// The result of a calibration: the coefficients of each centre-of-pressure method, as plain values. A calibration file contains exactly
// these; CopEstimator checks them and computes with them. w1..wn are deflections in mm, S is their sum.

namespace dts::physics {

/// Calibrated range of a quantity, including the margin.
struct Interval {
  double lowest = 0.0;
  double highest = 0.0;

  [[nodiscard]] bool contains(double value) const noexcept { return value >= lowest && value <= highest; }
  [[nodiscard]] double clamp(double value) const noexcept { return value < lowest ? lowest : value > highest ? highest : value; }

  friend bool operator==(const Interval&, const Interval&) = default;
};

/// Thesis eq. 4.1 for one axis: position = sum of quartic[k] (r - 1)^k, mm, over the ratio r of two deflections.
struct RatioFit {
  Interval ratio;
  std::array<double, 5> quartic{};

  friend bool operator==(const RatioFit&, const RatioFit&) = default;
};

/// Outputs x mm, y mm and S per load mm/N as polynomials of u = (w2+w4-w1-w3)/S, v = (w3+w4-w1-w2)/S and z = S/reference_sum_mm
/// (plate-model 5.2): output = sum over k of by_sum_power[k](u, v) z^k. The fourth output is unused.
struct SumPolynomial {
  static constexpr std::size_t kMaxSumPowers = 3;

  Interval u;
  Interval v;
  Interval relative_sum;
  double reference_sum_mm = 1.0;
  std::size_t sum_power_count = 1;  ///< 1: the load does not change the plate's shape; 2 or 3: it does.
  std::array<Quintic, kMaxSumPowers> by_sum_power{};

  friend bool operator==(const SumPolynomial&, const SumPolynomial&) = default;
};

struct Poly3Form {
  SumPolynomial polynomial;

  friend bool operator==(const Poly3Form&, const Poly3Form&) = default;
};

/// Per axis, one ratio of pair averages (`thesis`: (w1+w3)/(w2+w4) and (w1+w2)/(w3+w4)), or two ratios of single sensors, whose estimates
/// are averaged (`thesis_per_pair`: w1/w2, w3/w4 and w1/w3, w2/w4). The load is S divided by the third output of `load`.
struct ThesisForm {
  std::vector<RatioFit> x;
  std::vector<RatioFit> y;
  SumPolynomial load;

  friend bool operator==(const ThesisForm&, const ThesisForm&) = default;
};

/// Plate-model 5.4, n sensors: load = a . w; position = centre + (b . w) / (a . w). With quadratic terms, over shares s = w / S: position =
/// centre + sum over i <= j of q[ij] s_i s_j (the shares sum to 1, so that these terms include the linear ones).
struct MomentForm {
  Point centre;
  std::vector<double> load_n_per_mm;  ///< a, n values.
  std::vector<double> x_moment_n;     ///< b, n values: N mm per mm.
  std::vector<double> y_moment_n;
  std::vector<double> x_quadratic_mm;  ///< q, n (n + 1) / 2 values in the order 11 12 .. 1n 22 .. nn; empty: the ratio is used.
  std::vector<double> y_quadratic_mm;
  std::vector<Interval> share;  ///< Calibrated range of each share.

  friend bool operator==(const MomentForm&, const MomentForm&) = default;
};

/// Plate-model 5.3: the plate itself, inverted by Gauss-Newton.
struct ModelForm {
  PlateBehaviour behaviour = PlateBehaviour::Stiffening;
  core::Newtons heaviest;  ///< Largest load for which the stiffening is known.
  Plate plate;
  Support support;
  std::vector<Point> sensors;

  friend bool operator==(const ModelForm& one, const ModelForm& other) {
    const auto values = [](const ModelForm& form) {
      return std::tuple(form.behaviour, form.heaviest, form.plate.a, form.plate.b, form.plate.h, form.plate.e_pa, form.plate.nu,
                        form.support.kind, form.support.inset);
    };
    return values(one) == values(other) && one.sensors == other.sensors;
  }
};

using CopForm = std::variant<Poly3Form, ThesisForm, MomentForm, ModelForm>;

/// Range in which a calibration is valid, including the margin for noise at its border.
struct CopValidity {
  Interval x_mm;
  Interval y_mm;
  Interval load_n;

  friend bool operator==(const CopValidity&, const CopValidity&) = default;
};

}  // namespace dts::physics
