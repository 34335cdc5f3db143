// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>

#include "unit/lab/run_fixture.h"

namespace dts::lab::sway::made {

/// A CSV of 100 Hz with `count` rows of what the two functions say at a time in s, to the last digit.
inline std::string csv(int count, const std::function<double(double)>& ml_mm, const std::function<double(double)>& ap_mm) {
  std::string text = "t_s,x_mm,y_mm\n";
  for (int k = 0; k < count; ++k) {
    const double t_s = 0.01 * k;
    char row[120];
    std::snprintf(row, sizeof row, "%.2f,%.17g,%.17g\n", t_s, ml_mm(t_s), ap_mm(t_s));
    text += row;
  }
  return text;
}

/// Five seconds a turn, 10 mm from the middle.
inline std::string circle(int count, double radius_mm = 10.0) {
  const double turn = 2.0 * std::numbers::pi / 5.0;
  return csv(
      count, [=](double t_s) { return radius_mm * std::cos(turn * t_s); }, [=](double t_s) { return radius_mm * std::sin(turn * t_s); });
}

/// Somebody who sways: slow waves that do not repeat.
inline std::string swaying(int count, double size_mm, double seed) {
  const auto wave = [=](double t_s, double phase) {
    double value = 0.0;
    for (int k = 1; k <= 9; ++k) value += size_mm / k * std::sin(2.0 * std::numbers::pi * 0.11 * std::pow(k, 1.37) * t_s + phase * k * k);
    return value;
  };
  return csv(
      count, [=](double t_s) { return wave(t_s, seed); }, [=](double t_s) { return 1.6 * wave(t_s, seed + 0.5); });
}

}  // namespace dts::lab::sway::made
