// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "sim/reach_plan.h"

namespace dts::sim {

/// When a seated person performs reaches.
enum class ReachMode : std::uint8_t {
  Never,
  Cued,  ///< Only after a cue.
  Auto,  ///< Automatically, through targets at 80, 100, 120, 150 % of the arm and the maximum, until the first cue.
};

struct SeatedPersonOptions {
  physics::Person person;
  SittingHabits habits;
  ReachMode mode = ReachMode::Auto;
  bool has_fidgets = true;
  bool has_double_reaches = false;
  double sit_down_s = 2.5;                                      ///< First touch; before that the chair is empty.
  double stand_up_s = std::numeric_limits<double>::infinity();  ///< The moment at which the person begins to stand up, also during a reach.
  std::uint64_t seed = 1;
};

/// The load on the seat at one moment.
struct SeatedState {
  SeatLoad load;  ///< Force 0 while nobody is on the seat.
  bool is_there = false;
  double trunk_deg = std::numeric_limits<double>::quiet_NaN();  ///< True flexion.
  const ReachPlan* reach = nullptr;  ///< Current or next reach; nullptr: none planned. Valid until the next call.
};

/// A person on the chair over time: sits down, leans back, reaches, fidgets, shifts and stands up again. Values depend only on time, seed
/// and the cues. Time must never go backwards. Thread: one at a time. Realtime-safe: yes.
class SeatedPerson {
 public:
  /// Time from sitting down to sitting still.
  static constexpr double kSettlingS = 2.0;

  explicit SeatedPerson(const SeatedPersonOptions& options) noexcept;

  [[nodiscard]] const SeatedBody& body() const noexcept { return body_; }
  /// Receives a cue at `time_s`. With `is_go`, a reach starts a reaction time later, or after the current reach; ignores a target that is
  /// not positive.
  void hear(double time_s, bool is_go, double target_cm) noexcept;
  /// Plans a reach for `request` at its time, instead of the next planned reach.
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
  std::optional<ReachPlan> plan_;        ///< Current or next reach.
  std::optional<ReachRequest> waiting_;  ///< Cue received during another reach.
  std::uint32_t reaches_ = 0;
  std::uint64_t slots_ = 0;
  std::size_t target_ = 0;
  Unrest unrest_;
};

}  // namespace dts::sim
