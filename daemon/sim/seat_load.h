// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "physics/body/two_link.h"
#include "sim/reach_motion.h"

namespace dts::sim {

/// How a moving body loads the seat (reach-model section 4). It is not known which of the two the thesis computed.
enum class SeatLoadModel : std::uint8_t {
  Cop,     ///< The load of thighs and buttocks moves with the hip moment.
  Thesis,  ///< The hip moment changes the force, which is spread evenly over the plate.
};

/// Effective gains, not a complete balance of forces: the front of the frame and the feet carry the rest.
struct SeatLoadParameters {
  SeatLoadModel model = SeatLoadModel::Cop;
  double weight_kg = 70.0;
  double height_cm = 175.0;
  double seat_part = 0.70;               ///< Fraction of the weight that rests on the seat.
  std::optional<double> rest_force_n{};  ///< Replaces `seat_part`: thesis 5.4.2 uses 480 N for every person.
  double moment_gain_n_per_nm = 1.0;     ///< k_M; Thesis only.
  double lean_back_deg = 5.0;            ///< psi: angle of the trunk against the back rest; 0: it does not lean. Cop only: the thesis
                                         ///< assumes an upright trunk.
  double rest_y_mm = 64.0;               ///< y0, from the rear edge.
  double moment_to_place = 0.30;         ///< kappa
  double moment_to_feet = 0.12;          ///< lambda
  double feet_lever_m = 0.42;
  /// Reaches of at least this flexion leave the back rest completely. The sheet says 12 deg, but its fixtures (120 % at 3.4 deg) and trials
  /// (from 1.4 deg) leave the back rest completely.
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
  double y_mm = 0.0;        ///< Centre of the loaded patch from the rear edge.
  bool is_uniform = false;  ///< Spread evenly over the whole plate instead.
};

/// Thread: any. Realtime-safe: yes.
class SeatedBody {
 public:
  explicit SeatedBody(const SeatLoadParameters& parameters) noexcept;

  [[nodiscard]] const SeatLoadParameters& parameters() const noexcept { return parameters_; }
  [[nodiscard]] const physics::BodySegments& segments() const noexcept { return segments_; }
  /// Returns the resting posture: leaning back, the hand on the thigh.
  [[nodiscard]] UpperBody at_rest() const noexcept;
  /// Returns the posture at `progress` of the way from rest to `flexion_deg` with a horizontal arm. If `moves_trunk` is false, only the arm
  /// moves.
  [[nodiscard]] UpperBody on_the_way(const Travel& progress, double flexion_deg, bool moves_trunk) const noexcept;
  /// `lift`: 0 the trunk leans on the back rest as at rest .. 1 the trunk has left the back rest.
  [[nodiscard]] SeatLoad load(const UpperBody& body, double lift) const noexcept;

 private:
  [[nodiscard]] double hip_moment_nm(const UpperBody& body) const noexcept;

  SeatLoadParameters parameters_;
  physics::BodySegments segments_;
  double rest_force_n_;
  double back_moment_nm_;  ///< M_back: moment that the back rest carries at rest, negative.
  double rest_moment_nm_;
};

/// Returns how far a reach from 0 to `end_s` has lifted the trunk off the back rest (rho of reach-model section 4).
[[nodiscard]] double back_rest_lift(double time_s, double end_s, double flexion_deg, double lifting_deg) noexcept;

}  // namespace dts::sim
