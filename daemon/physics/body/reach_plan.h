// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "physics/body/counter_random.h"
#include "physics/body/reach_motion.h"
#include "physics/body/sitting_habits.h"

namespace dts::physics {

/// What a person sets out to do.
struct ReachRequest {
  std::uint32_t number = 1;  ///< Chooses what differs from trial to trial.
  double start_s = 0.0;
  double target_cm = 0.0;        ///< From the acromion.
  std::string_view condition{};  ///< "80", "150", "max"; must outlive the plan. Empty: none.
  bool is_double = false;        ///< Goes most of the way back and reaches again before it returns.
};

/// One reach as it will be, the public truth of a simulated trial. Thread: any. Realtime-safe: yes.
///
///     progress 1          ____            of arm and trunk together
///                       /      \          forward: one or more partial moves (a correction is one more)
///              0 ______/        \______
///                   t_on  t_hit t_back t_end
struct ReachPlan {
  struct Move {
    double start_s = 0.0;
    double duration_s = 0.0;
    double amount = 0.0;  ///< Of the way; negative goes back.
  };
  static constexpr std::size_t kMostMoves = 20;

  std::uint32_t number = 0;
  double target_cm = 0.0;
  std::string_view condition{};
  double on_s = 0.0;    ///< t_on: mechanical start.
  double hit_s = 0.0;   ///< t_hit: end of the forward phase, the last one of a double reach.
  double back_s = 0.0;  ///< t_back: begins to return.
  double end_s = 0.0;   ///< t_end
  double trunk_deg = 0.0;
  bool moves_trunk = false;  ///< Else the arm alone goes, the trunk stays where it leans.
  double tremor_deg = 0.0;
  double tremor_hz = 0.0;
  std::array<Move, kMostMoves> moves{};
  std::size_t move_count = 0;

  [[nodiscard]] Travel progress(double time_s) const noexcept;
  /// How far the back rest has been left, 0..1.
  [[nodiscard]] double lift(double time_s, double lifting_deg) const noexcept;
  /// Something of it is felt on the seat, a little longer than the movement lasts.
  [[nodiscard]] bool is_felt(double time_s) const noexcept { return time_s >= on_s - kMarginS && time_s <= end_s + kMarginS; }

  static constexpr double kMarginS = 0.06;  ///< Letting go of the back rest and leaning on it again.
};

/// Thread: any. Realtime-safe: yes.
[[nodiscard]] ReachPlan plan_reach(const Person& person, const SittingHabits& habits, const ReachRequest& request,
                                   const CounterRandom& random) noexcept;

/// The body at `time_s` of `plan`.
[[nodiscard]] SeatLoad seat_load(const SeatedBody& body, const ReachPlan& plan, double time_s) noexcept;

/// Trunk flexion then, deg.
[[nodiscard]] double flexion_deg(const SeatedBody& body, const ReachPlan& plan, double time_s) noexcept;

}  // namespace dts::physics
