// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "dts/v1/sessions.pb.h"
#include "session/protocol.h"

namespace dts::session {

/// One trial of the plan.
struct PlannedTrial {
  std::uint32_t trial = 1;  ///< Position in the plan, from 1.
  std::uint32_t block = 1;
  std::size_t condition = 0;  ///< Index into the plan's conditions.
  double cue_delay_s = 0.0;

  friend bool operator==(const PlannedTrial&, const PlannedTrial&) = default;
};

inline constexpr double kUndoS = 5.0;  ///< How long a redo or reject can be taken back. A plan that starts by itself waits so long.
inline constexpr std::uint32_t kMostTrials = 10'000;  ///< Maximum per plan; further trials are left out.
[[nodiscard]] std::uint32_t planned_trials(const TrialPlan& plan);
/// Returns how long all trials take, with the mean delay of the cue, settling and rest, in s. Nothing if trials last until a command. A
/// plan that does not start by itself takes longer, by the pauses of the user.
[[nodiscard]] std::optional<double> length_s(const TrialPlan& plan);

/// Returns the order of all trials. If a block has fewer trials than conditions, the next block continues with the others, so that the
/// counts of any two conditions over the whole plan differ by at most one. Without conditions there are no trials.
///
/// The same seed produces the same plan on every machine: random numbers from SplitMix64 (Steele, Lea, Flood: "Fast splittable pseudorandom
/// number generators", OOPSLA 2014) with rejection, order from the Fisher-Yates shuffle, because std::shuffle and the standard
/// distributions differ between libraries. Delays are whole milliseconds, to avoid differences in rounding.
[[nodiscard]] std::vector<PlannedTrial> make_plan(const TrialPlan& plan, std::uint64_t seed);

/// Waiting --next--> Ready --cue delay--> Settling --settle_s--> Measuring --duration_s, next--> Resting --rest--> Waiting ... Finished
enum class TrialPhase : std::uint8_t { Waiting = 1, Ready, Settling, Measuring, Resting, Finished };

/// A step of a trial: an event in the recording and on the bus.
enum class TrialEventKind : std::uint8_t {
  Ready = 1,  ///< The trial begins; the subject waits for the cue.
  Go,         ///< The cue. Settling, if any, begins.
  Measure,    ///< The measurement begins.
  Done,       ///< The trial is over, and valid unless redone or rejected later.
  Redone,     ///< This attempt is void; the trial is repeated.
  Rejected,   ///< This attempt is void; the plan continues with the next trial.
  Aborted,    ///< The session ended during the trial.
  Rest,       ///< Rest lasts `rest_s` from now on: after a trial, or again if a reject or an undo changes its end.
  Finished,   ///< All trials of the plan are done.
  Undone,     ///< Redone or Rejected is taken back. Attempts of this trial with a higher number are void.
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
  std::int64_t at_ns = 0;  ///< When the step was due. `tick` may detect it later, by up to the time between two calls.

  friend bool operator==(const TrialEvent&, const TrialEvent&) = default;
};

/// How the newest attempt that ended has ended.
struct EndedAttempt {
  TrialEventKind outcome = TrialEventKind::Done;  ///< Done, Redone, Rejected or Aborted.
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  v1::TrialFault fault = v1::TRIAL_FAULT_UNSPECIFIED;
};

/// What earlier parts of the session did with a trial of the plan.
struct EarlierTrial {
  std::uint32_t trial = 1;
  std::uint32_t newest_attempt = 1;
  bool is_done = false;  ///< It needs no repetition.

  friend bool operator==(const EarlierTrial&, const EarlierTrial&) = default;
};

/// Position of a session in its plan, for status answers.
struct TrialView {
  TrialPhase phase = TrialPhase::Waiting;
  std::uint32_t trial = 0;  ///< Current or last trial; 0: none yet.
  std::uint32_t attempt = 1;
  std::uint32_t block = 1;
  std::uint32_t of = 0;  ///< Number of trials in the plan.
  std::string condition{};
  std::uint32_t next_trial = 0;  ///< 0: none is left.
  std::string next_condition{};
  std::optional<double> next_target_cm;
  std::optional<double> next_target_percent;  ///< The same in percent of the arm length.
  double remaining_s = 0.0;                   ///< Of the phase; 0: waits for a command.
  double settle_s = 0.0;
  double duration_s = 0.0;                 ///< 0: until `next`.
  std::optional<double> target_cm;         ///< Of the current trial, else of the next one.
  std::optional<double> target_percent;    ///< The same in percent of the arm length.
  std::optional<EndedAttempt> last_ended;  ///< Nothing: no attempt has ended.
  double undo_s = 0.0;                     ///< How long `undo` is possible; 0: it is not.
  bool has_feedback = false;               ///< The subject sees the own COP: in the current trial, else in the next one.
  bool is_next_wanted = false;             ///< The first trial starts as soon as the session runs.
};

/// Runs the trials of the plan. Uses only the times passed to it. Every call first advances to its `now_ns`, so that its effect does not
/// depend on the last call of `tick`. Phases begin when they are due, so that delays do not add up. Thread: control.
class TrialRun {
 public:
  /// `fields` must have passed `check_fields`: targets depend on arm length and maximum reach. The run skips trials that
  /// earlier parts completed and starts with the first other one. Its attempts continue the numbers of the earlier parts.
  TrialRun(const TrialPlan& plan, std::uint64_t seed, const std::vector<std::pair<std::string, std::string>>& fields,
           const std::vector<EarlierTrial>& earlier = {});

  /// Starts the next trial (and ends a rest early), or ends a trial that has no duration. Fails with WrongState if another trial is under
  /// way (redo or reject it instead), or if all are done.
  [[nodiscard]] core::Status next(std::int64_t now_ns);
  /// Voids the current or last attempt and starts the trial again as a new attempt with a new cue delay; also possible after the last trial
  /// of the plan. Fails with WrongState if no trial was started or the attempt is void already.
  [[nodiscard]] core::Status redo(std::int64_t now_ns);
  /// Voids the current or last attempt and continues: with the rest, if the trial is under way. Fails with WrongState like `redo`.
  [[nodiscard]] core::Status reject(std::int64_t now_ns);
  /// Takes back the last `redo` or `reject`, within `kUndoS` and as long as neither another trial has begun nor the new attempt has ended.
  /// The attempt continues as if nothing had happened: settling and measurement end at the same time as without the interruption, and are
  /// over if this time has passed. A cue that was not given, and a rest, continue with the time that remained. Fails with WrongState if
  /// there is nothing to take back.
  [[nodiscard]] core::Status undo(std::int64_t now_ns);
  /// Ends the run with the session: a trial under way is aborted, and every later command fails with WrongState.
  void abort(std::int64_t now_ns);
  /// Advances to `now_ns`.
  void tick(std::int64_t now_ns);

  /// Returns whether all trials of the plan are done; `redo` can still reopen the last one.
  [[nodiscard]] bool is_finished() const noexcept { return phase_ == TrialPhase::Finished; }
  [[nodiscard]] TrialView view(std::int64_t now_ns) const;
  /// Returns the events since the last call, oldest first.
  [[nodiscard]] std::vector<TrialEvent> take_events();

 private:
  /// What `undo` restores.
  struct Before {
    std::int64_t voided_ns = 0;
    TrialPhase phase = TrialPhase::Waiting;
    std::optional<std::int64_t> phase_ends_ns;
    std::size_t upcoming = 0;
    std::uint32_t attempt = 1;
    std::optional<EndedAttempt> last_ended;
  };

  [[nodiscard]] bool is_under_way() const noexcept;
  [[nodiscard]] core::Status check_voidable() const;
  [[nodiscard]] std::int64_t undo_until_ns() const noexcept;
  void keep_for_undo(std::int64_t now_ns);
  void catch_up(std::int64_t now_ns);
  void end(std::int64_t at_ns);
  [[nodiscard]] std::size_t first_open_from(std::size_t place) const noexcept;
  [[nodiscard]] double rest_after_current_s() const noexcept;
  void start(std::size_t place, std::int64_t at_ns);
  void settle(std::int64_t at_ns);
  void measure(std::int64_t at_ns);
  void go_on(std::int64_t at_ns);
  void rest(double rest_s, std::int64_t at_ns);
  void stop_resting(std::int64_t at_ns);
  void leave_phase(std::int64_t at_ns);
  void enter(TrialPhase phase, std::int64_t at_ns, std::optional<double> length_s);
  void report(TrialEventKind kind, std::int64_t at_ns);

  TrialPlan plan_;
  std::uint64_t seed_;
  std::vector<PlannedTrial> places_;
  std::vector<std::optional<double>> targets_cm_;       ///< Per condition.
  std::vector<std::optional<double>> targets_percent_;  ///< Per condition.
  std::vector<bool> is_done_before_;                    ///< Per trial of the plan.
  std::vector<std::uint32_t> newest_attempts_;          ///< Per trial of the plan; 0: none. An undone redo does not free its number.
  TrialPhase phase_ = TrialPhase::Waiting;
  std::optional<std::int64_t> phase_ends_ns_;  ///< Nothing: a command ends it.
  std::optional<std::size_t> current_;         ///< Position of the current or last trial.
  std::size_t upcoming_ = 0;                   ///< Position that `next` starts; `places_.size()`: none.
  std::uint32_t attempt_ = 1;
  bool is_void_ = false;          ///< The current attempt is void.
  std::optional<Before> before_;  ///< Of the last redo or reject; nothing: it cannot be taken back any more.
  std::optional<EndedAttempt> last_ended_;
  bool has_ended_ = false;
  std::vector<TrialEvent> events_;
};

}  // namespace dts::session
