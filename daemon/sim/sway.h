// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "sim/cop_position.h"

namespace dts::sim {

inline constexpr double kStandardGravityMPerS2 = 9.81;

/// One axis of quiet standing: an inverted pendulum. Its ankle is held by passive elasticity and by a delayed proportional-derivative
/// command that is active only while the pendulum falls away.
///
///     I th'' = m g h th - T + n      T = K th + B th' + s (P th_d + D th'_d)      COP = T' / (m g)
///     s = 1 while th_d (th'_d - a th_d) > 0, else 0      x_d = x(t - delay)       T' = T - n
///
/// Asai et al. 2009, "A model of postural control in quiet standing", PLoS ONE 4:e6169: the intermittent controller without a dead zone. P,
/// D, a and the noise were checked against a figure caption of the paper; m, h, K, B and the switching rule against later public code of
/// the same model; the delay is quoted from memory. Values are from the paper unless a line states otherwise. The noise of the paper is
/// white, which makes the COP path infinitely long. Here the noise n is a torque of the ankle muscles behind two equal first-order lags.
/// The equations are homogeneous in (th, n): the noise sets only the size of the sway.
struct SwayModel {
  double mass_kg = 60.0;
  double centre_height_m = 1.0;
  double inertia_kg_m2 = 60.0;
  double passive_stiffness = 0.8;              ///< K, as a fraction of m g h.
  double passive_damping_nm_s_per_rad = 4.0;   ///< B.
  double command_stiffness = 0.30;             ///< P, as a fraction of m g h; paper 0.25 (RDIST would be 40 % larger).
  double command_damping_nm_s_per_rad = 10.0;  ///< D.
  double delay_s = 0.2;                        ///< At least 1 ms.
  double switching_slope_per_s = -0.4;         ///< a.
  double noise_nm_per_sqrt_hz = 0.18;          ///< Two-sided density of n below its corner; paper 0.2 on the body.
  double noise_lag_s = 0.09;                   ///< Each of the two lags; not in the paper.
};

/// Fitted by hand to young adults with open eyes (posturography section 9).
inline constexpr SwayModel kAnteroposteriorSway{};
/// In ML the legs make the body stiffer, and the sway is smaller and faster.
inline constexpr SwayModel kMediolateralSway{.command_stiffness = 0.35, .noise_nm_per_sqrt_hz = 0.13, .noise_lag_s = 0.08};

/// Models of both axes.
struct SwayModels {
  SwayModel ml;
  SwayModel ap;
};
inline constexpr SwayModels kTwoFeetSway{.ml = kMediolateralSway, .ap = kAnteroposteriorSway};
/// One foot, fitted by hand: faster and larger, in ML most. Mean speed ML 29, AP 22 mm/s, standard deviation 4 and 6 mm: below 34 and
/// 29 mm/s, which separate older adults with falls from those without (Oliveira et al. 2018, PLoS ONE 13:e0203887, one leg, open eyes).
inline constexpr SwayModels kOneFootSway{
    .ml =
        {.command_stiffness = 0.5, .command_damping_nm_s_per_rad = 30.0, .delay_s = 0.1, .noise_nm_per_sqrt_hz = 0.33, .noise_lag_s = 0.03},
    .ap = {.command_stiffness = 0.35, .command_damping_nm_s_per_rad = 30.0, .noise_nm_per_sqrt_hz = 0.30, .noise_lag_s = 0.035}};

/// One axis, 1 ms per step, with its own random numbers: std::mt19937_64 and our own Box-Muller, because each library implements
/// std::normal_distribution differently. The constructor allocates all memory.
class SwayAxis {
 public:
  /// Starts in the stationary state: simulates 30 s first.
  SwayAxis(const SwayModel& model, std::uint64_t seed);

  /// Returns the COP after the next millisecond, mm from the mean stance. Realtime-safe: yes.
  double next_mm() noexcept;
  /// Returns the horizontal acceleration of the centre of mass at the millisecond of the last `next_mm`. Realtime-safe: yes.
  [[nodiscard]] double acceleration_m_per_s2() const noexcept { return model_.centre_height_m * acceleration_rad_per_s2_; }

 private:
  struct State {
    double angle_rad = 0.0;
    double speed_rad_per_s = 0.0;
  };

  double gaussian() noexcept;
  double noise_torque_nm() noexcept;
  [[nodiscard]] double command_torque_nm(const State& delayed) const noexcept;

  SwayModel model_;
  double gravity_torque_nm_per_rad_;
  std::mt19937_64 random_;
  double spare_gaussian_ = 0.0;
  bool has_spare_gaussian_ = false;
  double first_lag_nm_ = 0.0;
  double noise_nm_ = 0.0;
  State state_;
  double acceleration_rad_per_s2_ = 0.0;
  std::vector<State> past_;  ///< Delay line; `oldest_` is the state one delay ago.
  std::size_t oldest_ = 0;
};

/// The centre of pressure, and the acceleration of the centre of mass that belongs to it.
struct SwayMotion {
  CopPosition cop;
  double ml_m_per_s2 = 0.0;
  double ap_m_per_s2 = 0.0;
};

/// Synthetic quiet standing in both axes. The same seed gives the same path for every sampling rate: the path is computed at 1 kHz and
/// interpolated linearly. Thread: one.
class Sway {
 public:
  explicit Sway(std::uint64_t seed, const SwayModels& models = kTwoFeetSway);

  /// Returns the COP from the mean stance at `time_s` since the start. Time must not go backwards by more than 1 ms (an older time counts
  /// as the oldest known one). Realtime-safe: yes; costs two steps per millisecond since the last call.
  [[nodiscard]] SwayMotion motion_at(double time_s) noexcept;
  /// Returns only the COP of `motion_at`. Realtime-safe: yes.
  [[nodiscard]] CopPosition at(double time_s) noexcept { return motion_at(time_s).cop; }

 private:
  [[nodiscard]] SwayMotion next() noexcept;
  void step() noexcept;

  SwayAxis ml_;
  SwayAxis ap_;
  SwayMotion before_;
  SwayMotion after_;
  std::uint64_t step_ = 0;  ///< `before_` is at this millisecond, `after_` at the next one.
};

}  // namespace dts::sim
