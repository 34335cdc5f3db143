// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "physics/body/reach_plan.h"

namespace dts::physics {

/// When a seated person reaches.
enum class ReachMode : std::uint8_t {
  Never,
  Cued,  ///< When told.
  Auto,  ///< By itself, through targets at 80, 100, 120, 150 % of the arm and the maximum, until it is told for the first time.
};

struct SeatedPersonOptions {
  Person person;
  SittingHabits habits;
  ReachMode mode = ReachMode::Auto;
  bool has_fidgets = true;
  bool has_double_reaches = false;
  double sit_down_s = 2.5;                                      ///< First touch: the chair is empty before.
  double stand_up_s = std::numeric_limits<double>::infinity();  ///< Begins to leave, whatever it is doing.
  std::uint64_t seed = 1;
};

/// What presses on the seat at one moment.
struct SeatedState {
  SeatLoad load;  ///< No force while nobody sits.
  bool is_there = false;
  double trunk_deg = std::numeric_limits<double>::quiet_NaN();  ///< True flexion.
  const ReachPlan* reach = nullptr;  ///< What is going on or comes next; nullptr: nothing is known. Valid until the next call.
};

/// A person on the chair over time: sits down, leans back, reaches, fidgets, shifts and stands up again. Values depend on time, seed and
/// what was heard only. Time never goes back. Thread: one at a time. Realtime-safe: yes.
class SeatedPerson {
 public:
  /// From sitting down to sitting still.
  static constexpr double kSettlingS = 2.0;

  explicit SeatedPerson(const SeatedPersonOptions& options) noexcept;

  [[nodiscard]] const SeatedBody& body() const noexcept { return body_; }
  /// Somebody says it at `time_s`. A reach begins a reaction time later, or after the one under way; a target that is not positive is none.
  void hear(double time_s, bool is_go, double target_cm) noexcept;
  /// A reach to `request`, at its time, in place of the one that comes next.
  void plan(const ReachRequest& request) noexcept;
  [[nodiscard]] SeatedState at(double time_s) noexcept;

 private:
  /// A fidget or a shift of posture.
  struct Unrest {
    double start_s = 0.0;
    double duration_s = 0.0;
    double from_mm = 0.0;
    double to_mm = 0.0;
    double wobble_mm = 0.0;
    double wobble_hz = 0.0;
  };

  void advance(double time_s) noexcept;
  void plan_next(double after_s) noexcept;
  void look_for_unrest(std::uint64_t slot, double slot_s) noexcept;
  [[nodiscard]] bool must_be_calm_at(double time_s) const noexcept;
  [[nodiscard]] double shifted_mm(double time_s) const noexcept;
  void disturb(SeatLoad& load, double time_s) const noexcept;

  SeatedPersonOptions options_;
  CounterRandom random_;
  SeatedBody body_;
  std::optional<ReachPlan> plan_;        ///< Under way, or next.
  std::optional<ReachRequest> waiting_;  ///< Heard while another one was under way.
  std::uint32_t reaches_ = 0;
  std::uint64_t slots_ = 0;
  std::size_t target_ = 0;
  Unrest unrest_;
};

}  // namespace dts::physics
