// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "session/protocol.h"

namespace dts::session {

/// One place of the plan.
struct PlannedTrial {
  std::uint32_t trial = 1;  ///< Place in the plan, from 1.
  std::uint32_t block = 1;
  std::size_t condition = 0;  ///< Index into the plan's conditions.
  double cue_delay_s = 0.0;

  friend bool operator==(const PlannedTrial&, const PlannedTrial&) = default;
};

inline constexpr std::uint32_t kMostTrials = 10'000;  ///< Of a plan; what lies beyond is left out.
[[nodiscard]] std::uint32_t planned_trials(const TrialPlan& plan);

/// The order of all trials. Blocks of fewer trials than conditions take turns, so that over all blocks every condition comes equally often,
/// give or take one. No conditions, no trials.
///
/// The same seed gives the same plan on every machine: numbers come from SplitMix64 (Steele, Lea, Flood: "Fast splittable pseudorandom
/// number generators", OOPSLA 2014) by rejection, the order from Fisher and Yates' shuffle, since the results of std::shuffle and of the
/// standard distributions differ between libraries; delays are drawn in whole milliseconds, so that no rounding differs.
[[nodiscard]] std::vector<PlannedTrial> make_plan(const TrialPlan& plan, std::uint64_t seed);

/// Waiting --next--> Ready --cue delay--> Settling --settle_s--> Measuring --duration_s, next--> Resting --rest--> Waiting ... Finished
enum class TrialPhase : std::uint8_t { Waiting = 1, Ready, Settling, Measuring, Resting, Finished };

/// What happened in a trial: an event in the recording and on the bus.
enum class TrialEventKind : std::uint8_t {
  Ready = 1,  ///< The trial begins; the subject waits for the cue.
  Go,         ///< The cue. Settling, if any, begins.
  Measure,    ///< What follows counts.
  Done,       ///< It is over, and counts unless redone or rejected later.
  Redone,     ///< The trial named is void; the same place of the plan comes again.
  Rejected,   ///< The trial named is void; the plan goes on.
  Aborted,    ///< The session ended in the middle of it.
  Rest,       ///< Rest begins; `rest_s` says how long.
  Finished,   ///< All trials of the plan are done.
};
[[nodiscard]] std::string_view name(TrialPhase phase) noexcept;
[[nodiscard]] std::string_view name(TrialEventKind kind) noexcept;

struct TrialEvent {
  TrialEventKind kind = TrialEventKind::Ready;
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  std::uint32_t block = 1;
  std::string condition{};
  std::vector<std::pair<std::string, std::string>> labels{};
  std::optional<double> target_cm;  ///< From the acromion, of this subject.
  double rest_s = 0.0;
  std::int64_t at_ns = 0;  ///< When it was due: before the `tick` that found it, by up to the time between two.

  friend bool operator==(const TrialEvent&, const TrialEvent&) = default;
};

/// Where a session stands in its plan, for status answers.
struct TrialView {
  TrialPhase phase = TrialPhase::Waiting;
  std::uint32_t trial = 0;  ///< Under way, or done last; 0: none yet.
  std::uint32_t attempt = 1;
  std::uint32_t block = 1;
  std::uint32_t of = 0;  ///< Trials of the plan.
  std::string condition{};
  std::string next_condition{};
  std::optional<double> next_target_cm;
  double remaining_s = 0.0;  ///< Of the phase; 0: it waits for a command.
};

/// Walks a subject through the plan. Knows time only as what it is told. Every call lets time pass first, so that what it does depends on
/// the time it is given and not on when `tick` was called last; phases begin when they are due, so that lateness does not add up. Thread:
/// control.
class TrialRun {
 public:
  /// `fields` have passed `check_fields`: arm length and maximum reach make the targets' distances. `done`: places of the plan that earlier
  /// parts of the session are through with; the run goes on with the first place that is not among them, and passes over the others.
  TrialRun(const TrialPlan& plan, std::uint64_t seed, const std::vector<std::pair<std::string, std::string>>& fields,
           const std::vector<std::uint32_t>& done = {});

  /// Starts the next trial (also cutting a rest short), or ends one that has no duration of its own and waits for it.
  /// WrongState: a trial is under way that this does not end (redo or reject it instead), or all are done.
  [[nodiscard]] core::Status next(std::int64_t now_ns);
  /// Voids the trial under way, or else the last one, and starts it again as another attempt, with another delay of the cue; also after the
  /// last trial of the plan. WrongState: there was none, or it is void already.
  [[nodiscard]] core::Status redo(std::int64_t now_ns);
  /// Voids it and goes on: to the rest when it was under way. WrongState as above.
  [[nodiscard]] core::Status reject(std::int64_t now_ns);
  /// The session ends: a trial under way is aborted. From then on every command fails with WrongState.
  void abort(std::int64_t now_ns);
  /// Lets time pass.
  void tick(std::int64_t now_ns);

  /// All trials of the plan are done; `redo` can still take that back.
  [[nodiscard]] bool is_finished() const noexcept { return phase_ == TrialPhase::Finished; }
  [[nodiscard]] TrialView view(std::int64_t now_ns) const;
  /// What happened since the last call, oldest first.
  [[nodiscard]] std::vector<TrialEvent> take_events();

 private:
  [[nodiscard]] bool is_under_way() const noexcept;
  [[nodiscard]] core::Status check_voidable() const;
  [[nodiscard]] std::size_t first_open_from(std::size_t place) const noexcept;
  [[nodiscard]] double rest_after_current_s() const noexcept;
  void start(std::size_t place, std::uint32_t attempt, std::int64_t at_ns);
  void settle(std::int64_t at_ns);
  void measure(std::int64_t at_ns);
  void go_on(std::int64_t at_ns);
  void stop_resting(std::int64_t at_ns);
  void leave_phase(std::int64_t at_ns);
  void enter(TrialPhase phase, std::int64_t at_ns, std::optional<double> length_s);
  void tell(TrialEventKind kind, std::int64_t at_ns);

  TrialPlan plan_;
  std::uint64_t seed_;
  std::vector<PlannedTrial> places_;
  std::vector<std::optional<double>> targets_cm_;  ///< Per condition.
  std::vector<bool> is_done_before_;               ///< Per place.
  TrialPhase phase_ = TrialPhase::Waiting;
  std::optional<std::int64_t> phase_ends_ns_;  ///< Nothing: a command ends it.
  std::optional<std::size_t> current_;         ///< Place under way, or the last one.
  std::size_t upcoming_ = 0;                   ///< Place that `next` starts; `places_.size()`: none.
  std::uint32_t attempt_ = 1;
  bool is_void_ = false;  ///< The current trial.
  bool has_ended_ = false;
  std::vector<TrialEvent> events_;
};

}  // namespace dts::session
