// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/result.h"
#include "physics/cop/cop_trials.h"
#include "physics/cop/two_feet.h"

namespace dts::physics {

/// A person on two feet: one stance, and where the load is while the person sways.
struct TwoFeetStance {
  double width_mm = 0.0;              ///< Between the middle lines of the feet.
  double stated_width_mm = 0.0;       ///< As a clinic knows it: wrong by up to 20 mm.
  std::vector<CopTrial> positions{};  ///< The mean position first, then positions of the sway.
};

inline constexpr std::size_t kTwoFeetStances = 3000;
inline constexpr double kWidthErrorMm = 20.0;  ///< Largest error of a stated stance width.

/// Returns `count` random stances of the library of sheet two-feet, each with its mean position and six positions of the sway: people of
/// 45 to 110 kg, 110 to 260 mm wide, on feet of three random patches. The same seed gives the same stances. Returns fewer than `count` if
/// the plate is too small for most stances.
[[nodiscard]] std::vector<TwoFeetStance> two_feet_stances(const Plate& plate, std::size_t count, std::uint64_t seed);

struct TwoFeetFit {
  TwoFeetForm form{};
  /// The lightest of the simulated people who bend the plate beyond the sensors' travel, N; absent: nobody does.
  std::optional<double> too_heavy_n{};
};

/// Fits the correction for a rig: computes the deflections of its plate model under `stances` random people, applies the point calibration
/// of the same model, and fits polynomials to the errors. The correction applies on top of the rig's own point calibration, measured or
/// not. `progress` receives the finished part, 0..1. Takes seconds. Fails as CopEstimator::from_model, and with InvalidArgument if the
/// plate is too small for two feet or has too little contact with them.
[[nodiscard]] core::Result<TwoFeetFit> fit_two_feet(
    CopMethod method, const RigModel& rig, std::size_t stances = kTwoFeetStances,
    const std::function<void(double)>& progress = [](double) {});

}  // namespace dts::physics
