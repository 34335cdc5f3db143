// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/resolution/detection.h"

namespace dts::lab::resolution {

/// How many reaches a decision may use.
inline constexpr std::array<int, 3> kReaches = {1, 3, 10};

/// Measures of a reach that a turn of the trunk changes. A reach that the daemon's stages do not find has the value 0.
enum class Measure : std::uint8_t {
  Rise = 0,     ///< d2 / P1: rise of the transient, as a fraction of its rest.
  RatioChange,  ///< Change of the ratio front to rear: how far the centre of pressure moves forward.
  Dip,          ///< d1 / P1: the trunk leaves the back rest.
  Any,          ///< One of the three, which divide the 5 % of false alarms among them.
};
inline constexpr std::size_t kMeasures = 4;
inline constexpr auto kAny = static_cast<std::size_t>(Measure::Any);

template <typename Value>
using ByMeasure = std::array<std::array<Value, kReaches.size()>, kMeasures>;  ///< [measure][k] with kReaches[k] reaches.

struct ResolutionOptions {
  std::vector<double> noises_mv{1.0, 3.0, 10.0};  ///< Of one scan of a sensor, rms.
  std::vector<double> rates_hz{100.0, 1500.0};
  std::size_t people = 8;
  int reaches = 15;  ///< Of each person at each turn of the trunk; three times as many with the arm alone.
  std::uint64_t seed = 1;
};

/// The result of one person.
struct PersonResolution {
  std::string name;
  double weight_kg = 0.0;
  ByMeasure<LimitInterval> limits{};
  double missed_part = 0.0;  ///< Fraction of the reaches that were not found.
};

/// All people with one noise and one rate.
struct Setup {
  double noise_mv = 0.0;
  double rate_hz = 0.0;
  std::vector<PersonResolution> people;
  ByMeasure<LimitInterval> medians{};
  ByMeasure<Limit> worst_tenth{};  ///< Nine in ten people have a smaller limit.
};

struct Resolution {
  std::uint64_t seed = 1;
  int reaches = 0;
  std::vector<Setup> setups;  ///< By noise, then by rate.
};

/// Simulates people who reach to a target at 100 % of the arm, each with the arm alone and with the trunk turned by 0.5 to 20 deg from its
/// rest at the back rest, and finds the smallest turn that differs from none. The people, their reaches and the noise of each scan
/// are the same in all setups. Synthetic. The same options give the same result. Fails with InvalidArgument if an option is invalid.
[[nodiscard]] core::Result<Resolution> find_resolution(const ResolutionOptions& options, const std::function<void(double)>& progress);

}  // namespace dts::lab::resolution
