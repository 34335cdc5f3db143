// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <vector>

#include "posturography/analysis.h"
#include "posturography/prepare.h"

namespace dts::posturography::test {

/// Normal numbers that are the same on every machine and with every library (xorshift64*, Box and Muller).
class Noise {
 public:
  explicit Noise(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15U + 1U) {}

  [[nodiscard]] double uniform() {
    state_ ^= state_ >> 12U;
    state_ ^= state_ << 25U;
    state_ ^= state_ >> 27U;
    return (static_cast<double>((state_ * 0x2545F4914F6CDD1DU) >> 11U) + 0.5) * 0x1p-53;
  }
  [[nodiscard]] double normal() { return std::sqrt(-2.0 * std::log(uniform())) * std::cos(2.0 * std::numbers::pi * uniform()); }

 private:
  std::uint64_t state_;
};

/// A series from a function of the sample's number that gives {ml, ap}.
template <class PointAt>
CopSeries series_of(double rate_hz, std::size_t count, PointAt point_at) {
  CopSeries series{.rate_hz = rate_hz};
  for (std::size_t i = 0; i < count; ++i) {
    const auto [ml, ap] = point_at(i);
    series.ml_mm.push_back(ml);
    series.ap_mm.push_back(ap);
  }
  return series;
}

struct Position {
  double ml_mm;
  double ap_mm;
};

/// What a person standing looks like: slow random sway with a restoring pull, some mm.
inline CopSeries standing(std::uint64_t seed, double rate_hz, std::size_t count) {
  Noise noise(seed);
  double ml = 0.0;
  double ap = 0.0;
  double ml_velocity = 0.0;
  double ap_velocity = 0.0;
  const double dt = 1.0 / rate_hz;
  return series_of(rate_hz, count, [&](std::size_t) {
    ml_velocity += (-8.0 * ml_velocity - 6.0 * ml) * dt + 60.0 * std::sqrt(dt) * noise.normal();
    ap_velocity += (-6.0 * ap_velocity - 4.0 * ap) * dt + 70.0 * std::sqrt(dt) * noise.normal();
    ml += ml_velocity * dt;
    ap += ap_velocity * dt;
    return Position{12.0 + ml, 45.0 + ap};
  });
}

/// As reports and the daemon analyse.
inline constexpr AnalysisOptions kReportOptions{.preparation = kReportPreparation};

/// Takes the mean away.
inline void centre(std::vector<double>& values) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  for (double& value : values) value -= mean;
}

/// As `prepare` with the profile asis; lp10 on request, without filtering.
inline Prepared prepared_of(const CopSeries& series, Profile as = Profile::AsIs) {
  Prepared prepared = prepare(series, {.profile = Profile::AsIs}).value();
  prepared.profile = as;
  return prepared;
}

}  // namespace dts::posturography::test
