// SPDX-License-Identifier: Apache-2.0
#include "sim/sway.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "physics/conversions.h"

namespace dts::sim {
namespace {

constexpr double kStepS = 1e-3;
constexpr double kStepsPerSecond = 1000.0;
constexpr int kWarmUpSteps = 30'000;
constexpr std::uint64_t kSecondAxisSeed = 0x9e3779b97f4a7c15ULL;  // Keeps the axes' random numbers apart for every seed.

std::size_t delay_steps(double delay_s) { return static_cast<std::size_t>(std::max(1.0, std::round(delay_s * kStepsPerSecond))); }

}  // namespace

SwayAxis::SwayAxis(const SwayModel& model, std::uint64_t seed)
    : model_(model),
      gravity_torque_nm_per_rad_(model.mass_kg * kStandardGravityMPerS2 * model.centre_height_m),
      random_(seed),
      past_(delay_steps(model.delay_s)) {
  for (int i = 0; i < kWarmUpSteps; ++i) next_mm();
}

double SwayAxis::next_mm() noexcept {
  const double command = command_torque_nm(past_[oldest_]);
  past_[oldest_] = state_;
  oldest_ = (oldest_ + 1) % past_.size();

  const double passive = model_.passive_stiffness * gravity_torque_nm_per_rad_ * state_.angle_rad +
                         model_.passive_damping_nm_s_per_rad * state_.speed_rad_per_s;
  const double ankle_torque_nm = passive + command - noise_torque_nm();
  const double falling_torque_nm = gravity_torque_nm_per_rad_ * state_.angle_rad;
  acceleration_rad_per_s2_ = (falling_torque_nm - ankle_torque_nm) / model_.inertia_kg_m2;
  state_.angle_rad += kStepS * state_.speed_rad_per_s;
  state_.speed_rad_per_s += kStepS * acceleration_rad_per_s2_;
  return physics::kMillimetresPerMetre * ankle_torque_nm / (model_.mass_kg * kStandardGravityMPerS2);
}

double SwayAxis::command_torque_nm(const State& delayed) const noexcept {
  const double side = delayed.angle_rad * (delayed.speed_rad_per_s - model_.switching_slope_per_s * delayed.angle_rad);
  if (side <= 0.0) return 0.0;  // The pendulum returns to upright without help.
  return model_.command_stiffness * gravity_torque_nm_per_rad_ * delayed.angle_rad +
         model_.command_damping_nm_s_per_rad * delayed.speed_rad_per_s;
}

double SwayAxis::noise_torque_nm() noexcept {
  const double white = model_.noise_nm_per_sqrt_hz * gaussian() * std::sqrt(kStepsPerSecond);
  first_lag_nm_ += (white - first_lag_nm_) * kStepS / model_.noise_lag_s;
  noise_nm_ += (first_lag_nm_ - noise_nm_) * kStepS / model_.noise_lag_s;
  return noise_nm_;
}

double SwayAxis::gaussian() noexcept {
  if (has_spare_gaussian_) {
    has_spare_gaussian_ = false;
    return spare_gaussian_;
  }
  constexpr double kUnit = 0x1p-53;
  const double u = (static_cast<double>(random_() >> 11) + 1.0) * kUnit;  // (0, 1]: its logarithm is finite
  const double v = static_cast<double>(random_() >> 11) * kUnit;
  const double radius = std::sqrt(-2.0 * std::log(u));
  spare_gaussian_ = radius * std::sin(2.0 * std::numbers::pi * v);
  has_spare_gaussian_ = true;
  return radius * std::cos(2.0 * std::numbers::pi * v);
}

Sway::Sway(std::uint64_t seed, const SwayModels& models) : ml_(models.ml, seed ^ kSecondAxisSeed), ap_(models.ap, seed) {
  after_ = next();
  step();
  step_ = 0;
}

SwayMotion Sway::next() noexcept {
  const CopPosition cop{ml_.next_mm(), ap_.next_mm()};
  return {cop, ml_.acceleration_m_per_s2(), ap_.acceleration_m_per_s2()};
}

void Sway::step() noexcept {
  before_ = after_;
  after_ = next();
  ++step_;
}

SwayMotion Sway::motion_at(double time_s) noexcept {
  const double position = std::max(0.0, time_s * kStepsPerSecond);
  while (position >= static_cast<double>(step_ + 1)) step();
  const double part = std::max(0.0, position - static_cast<double>(step_));
  const auto between = [part](double before, double after) { return before + part * (after - before); };
  return {.cop = {between(before_.cop.ml_mm, after_.cop.ml_mm), between(before_.cop.ap_mm, after_.cop.ap_mm)},
          .ml_m_per_s2 = between(before_.ml_m_per_s2, after_.ml_m_per_s2),
          .ap_m_per_s2 = between(before_.ap_m_per_s2, after_.ap_m_per_s2)};
}

}  // namespace dts::sim
