// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "sim/counter_random.h"
#include "sim/reach_motion.h"
#include "sim/sitting_habits.h"

namespace dts::sim {

/// A reach that a person is to perform.
struct ReachRequest {
  std::uint32_t number = 1;  ///< Selects the random variation from trial to trial.
  double start_s = 0.0;
  double target_cm = 0.0;             ///< From the acromion.
  std::string_view condition{};       ///< "80", "150", "max"; must outlive the plan. Empty: no condition.
  std::optional<double> trunk_deg{};  ///< Final flexion of the trunk, whatever the target needs; empty: what it needs.
  bool is_double = false;             ///< The person moves most of the way back and reaches again before the return.
};

/// The planned course of one reach; the published ground truth of a simulated trial. Thread: any. Realtime-safe: yes.
///
///     progress 1          ____            of arm and trunk together
///                       /      \          forward: one or more partial moves (a correction is one more)
///              0 ______/        \______
///                   t_on  t_hit t_back t_end
struct ReachPlan {
  struct Move {
    double start_s = 0.0;
    double duration_s = 0.0;
    double amount = 0.0;  ///< Fraction of the way; negative: backward.
  };
  static constexpr std::size_t kMostMoves = 20;

  std::uint32_t number = 0;
  double target_cm = 0.0;
  std::string_view condition{};
  double on_s = 0.0;    ///< t_on: mechanical start.
  double hit_s = 0.0;   ///< t_hit: end of the forward phase; of the last one in a double reach.
  double back_s = 0.0;  ///< t_back: start of the return.
  double end_s = 0.0;   ///< t_end
  double trunk_deg = 0.0;
  bool moves_trunk = false;  ///< false: only the arm moves; the trunk keeps its lean.
  double tremor_deg = 0.0;
  double tremor_hz = 0.0;
  std::array<Move, kMostMoves> moves{};
  std::size_t move_count = 0;

  [[nodiscard]] Travel progress(double time_s) const noexcept;
  /// Returns how far the trunk has left the back rest, 0..1.
  [[nodiscard]] double lift(double time_s, double lifting_deg) const noexcept;
  /// Returns whether the seat load is affected; this lasts slightly longer than the movement.
  [[nodiscard]] bool is_felt(double time_s) const noexcept { return time_s >= on_s - kMarginS && time_s <= end_s + kMarginS; }

  static constexpr double kMarginS = 0.06;  ///< Time to leave the back rest, and to lean on it again.
};

/// Thread: any. Realtime-safe: yes.
[[nodiscard]] ReachPlan plan_reach(const physics::Person& person, const SittingHabits& habits, const ReachRequest& request,
                                   const CounterRandom& random) noexcept;

/// Returns the load of the body on the seat at `time_s` of `plan`.
[[nodiscard]] SeatLoad seat_load(const SeatedBody& body, const ReachPlan& plan, double time_s) noexcept;

/// Returns the trunk flexion at `time_s`, deg.
[[nodiscard]] double flexion_deg(const SeatedBody& body, const ReachPlan& plan, double time_s) noexcept;

}  // namespace dts::sim
