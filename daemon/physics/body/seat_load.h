// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "physics/body/reach_motion.h"
#include "physics/body/two_link.h"

namespace dts::physics {

/// How a moving body loads the seat (reach-model section 4). Which of them the thesis computed is a guess.
enum class SeatLoadModel : std::uint8_t {
  Cop,     ///< The load of thighs and buttocks wanders with the hip's moment.
  Thesis,  ///< The hip's moment changes the force, spread evenly over the plate.
};

/// Effective gains, not a closed balance: the front of the frame and the feet carry the rest.
struct SeatLoadParameters {
  SeatLoadModel model = SeatLoadModel::Cop;
  double weight_kg = 70.0;
  double height_cm = 175.0;
  double seat_part = 0.70;               ///< Of the weight that rests on the seat.
  std::optional<double> rest_force_n{};  ///< Instead of that part: thesis 5.4.2 takes 480 N for everybody.
  double moment_gain_n_per_nm = 1.0;     ///< k_M; Thesis only.
  double lean_back_deg = 5.0;            ///< psi: the trunk against the back rest; 0: it does not lean. Cop only: the thesis's is upright.
  double rest_y_mm = 64.0;               ///< y0, from the rear edge.
  double moment_to_place = 0.30;         ///< kappa
  double moment_to_feet = 0.12;          ///< lambda
  double feet_lever_m = 0.42;
  /// Reaches of at least this flexion leave the back rest altogether. The sheet writes 12 deg, but its fixtures (120 % at 3.4 deg) and
  /// trials (from 1.4 deg) let go of it completely.
  double lifting_deg = 1.5;
};

/// Angles of the trunk (flexion, 0 upright, + forward) and of the arm (from the horizontal, -50 deg on the thigh): rad.
struct UpperBody {
  Travel flexion;
  Travel arm;
};

inline constexpr double kArmOnThighDeg = -50.0;

/// A force on the seat.
struct SeatLoad {
  double force_n = 0.0;
  double y_mm = 0.0;        ///< Middle of the loaded patch from the rear edge.
  bool is_uniform = false;  ///< All over the plate instead.
};

/// Thread: any. Realtime-safe: yes.
class SeatedBody {
 public:
  explicit SeatedBody(const SeatLoadParameters& parameters) noexcept;

  [[nodiscard]] const SeatLoadParameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] const BodySegments& segments() const noexcept { return segments_; }
  /// Leaning back, the hand on the thigh.
  [[nodiscard]] UpperBody at_rest() const noexcept;
  /// `progress` of the way from rest to `flexion_deg` with a horizontal arm; with `moves_trunk` false only the arm goes.
  [[nodiscard]] UpperBody on_the_way(const Travel& progress, double flexion_deg, bool moves_trunk) const noexcept;
  /// `lift`: 0 the trunk leans on the back rest as much as it would at rest .. 1 it has left it.
  [[nodiscard]] SeatLoad load(const UpperBody& body, double lift) const noexcept;

 private:
  [[nodiscard]] double hip_moment_nm(const UpperBody& body) const noexcept;

  SeatLoadParameters parameters_;
  BodySegments segments_;
  double rest_force_n_;
  double back_moment_nm_;  ///< M_back: what the back rest carries at rest, negative.
  double rest_moment_nm_;
};

/// How far a reach that begins at 0 and ends at `end_s` has taken the trunk off the back rest (rho of reach-model section 4).
[[nodiscard]] double back_rest_lift(double time_s, double end_s, double flexion_deg, double lifting_deg) noexcept;

}  // namespace dts::physics
