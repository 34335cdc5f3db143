// SPDX-License-Identifier: Apache-2.0
#include "lab/training/left_out_parts.h"

#include <algorithm>
#include <cmath>

#include "classifier/trunk_model_parts.h"

namespace dts::lab::training {
namespace {

using classifier::class_index;
using classifier::kClasses;
using core::TrunkClass;

constexpr double kIntervalPart = 0.9;
constexpr std::size_t kEnoughResiduals = 20;  ///< With fewer in a band, all bands are combined.
constexpr double kLeastResidualDeg = 0.5;
/// Uncertainty and contradictions are classified again, with temperature and interval.
constexpr std::uint16_t kRejecting = core::class_reason::kOutOfRange | core::class_reason::kBadReach;

bool counts(const ClassifiedReach& one, std::optional<std::size_t> without) {
  return one.group != without && one.reach->wanted >= TrunkClass::Minor;
}

}  // namespace

std::vector<Forecast> forecasts_of(std::span<const ClassifiedReach> classified, std::optional<std::size_t> without) {
  std::vector<Forecast> forecasts;
  for (const ClassifiedReach& one : classified) {
    if (counts(one, without)) forecasts.push_back({one.movement.probability, static_cast<std::size_t>(one.reach->wanted) - 1});
  }
  return forecasts;
}

std::array<double, kClasses> residuals_of(std::span<const ClassifiedReach> classified, std::optional<std::size_t> without) {
  std::array<std::vector<double>, kClasses> by_class;
  std::vector<double> all;
  for (const ClassifiedReach& one : classified) {
    if (!counts(one, without) || !std::isfinite(one.movement.trunk_deg)) continue;
    const double residual_deg = std::abs(one.movement.trunk_deg - one.reach->flexion_deg);
    by_class[class_index(one.movement.trunk_deg)].push_back(residual_deg);
    all.push_back(residual_deg);
  }
  std::array<double, kClasses> residuals{};
  for (std::size_t k = 0; k < kClasses; ++k) {
    residuals[k] =
        std::max(kLeastResidualDeg, conformal_quantile(by_class[k].size() < kEnoughResiduals ? all : by_class[k], kIntervalPart));
  }
  return residuals;
}

double none_from_of(std::span<const ClassifiedReach> classified, std::optional<std::size_t> without) {
  constexpr double kLostPart = 0.01;
  std::vector<double> of_minor;
  for (const ClassifiedReach& one : classified) {
    const bool is_minor = one.group != without && one.reach->wanted == TrunkClass::Minor;
    if (is_minor && std::isfinite(one.arm_alone)) of_minor.push_back(one.arm_alone);
  }
  return std::clamp(conformal_quantile(of_minor, 1.0 - kLostPart) + 1e-6, 0.5 + 1e-6, 1.0);
}

TrunkClass guess_of(const ClassifiedReach& classified, double none_from) {
  const TrunkClass guess = classified.movement.trunk_class;
  if (guess != TrunkClass::None && guess != TrunkClass::Minor) return guess;
  return classified.arm_alone >= none_from ? TrunkClass::None : TrunkClass::Minor;
}

classifier::Network::Outputs tempered(classifier::Network::Outputs probability, double temperature) {
  double total = 0.0;
  for (double& value : probability) total += value = std::pow(value, 1.0 / temperature);
  for (double& value : probability) value /= total;
  return probability;
}

bool is_kept(const core::TrunkMovement& movement, const std::array<double, kClasses>& half_widths_deg, double reject_below) {
  if ((movement.reasons & kRejecting) != 0 || !(std::ranges::max(movement.probability) >= reject_below)) return false;
  if (!std::isfinite(movement.trunk_deg)) return true;
  const auto guess = static_cast<std::size_t>(std::max(1, static_cast<int>(movement.trunk_class)) - 1);
  const double width_deg = half_widths_deg[class_index(movement.trunk_deg)];
  return class_index(movement.trunk_deg - width_deg) <= guess && class_index(movement.trunk_deg + width_deg) >= guess;
}

}  // namespace dts::lab::training
