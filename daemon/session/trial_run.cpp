// SPDX-License-Identifier: Apache-2.0
#include "session/trial_run.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/split_mix.h"

namespace dts::session {
namespace {

constexpr double kLongestPhaseS = 7.0 * 86400.0;

/// Converts a time to whole units. Accepts any number: plans are checked where they are read, but this function does not rely on it.
std::int64_t whole(double seconds, double per_second) {
  if (!(seconds > 0.0)) return 0;
  return std::llround(std::min(seconds, kLongestPhaseS) * per_second);
}
std::int64_t nanoseconds(double seconds) { return whole(seconds, 1e9); }
std::int64_t milliseconds(double seconds) { return whole(seconds, 1e3); }

class SplitMix64 {
 public:
  explicit SplitMix64(std::uint64_t seed) noexcept : state_(seed) {}

  std::uint64_t next() noexcept { return core::split_mix(state_ += core::kGoldenGamma); }
  /// Returns a number evenly distributed in [0, bound): rejects draws that would favour small numbers. `bound` is at least 1.
  std::uint64_t below(std::uint64_t bound) noexcept {
    const std::uint64_t first_fair = (0 - bound) % bound;  // 2^64 modulo bound
    std::uint64_t drawn = next();
    while (drawn < first_fair) drawn = next();
    return drawn % bound;
  }
  template <class Iterator>
  void shuffle(Iterator first, Iterator last) noexcept {
    for (auto left = last - first; left > 1; --left) {
      const auto drawn = static_cast<std::ptrdiff_t>(below(static_cast<std::uint64_t>(left)));
      std::iter_swap(first + (left - 1), first + drawn);
    }
  }

 private:
  std::uint64_t state_;
};

/// Each attempt has its own delay, so that a subject who repeats a trial cannot know it.
double cue_delay_s(const TrialPlan& plan, std::uint64_t seed, std::uint32_t trial, std::uint32_t attempt) {
  const std::int64_t shortest_ms = milliseconds(plan.cue_delay_min_s);
  const std::int64_t longest_ms = std::max(shortest_ms, milliseconds(plan.cue_delay_max_s));
  SplitMix64 place_and_attempt((std::uint64_t{trial} << 32U) | attempt);
  SplitMix64 random(seed ^ place_and_attempt.next());
  const auto drawn_ms = static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(longest_ms - shortest_ms) + 1));
  return static_cast<double>(shortest_ms + drawn_ms) / 1000.0;
}

/// Repeats the list of conditions and cuts it into blocks: in any section, the counts of two conditions differ by at most one. If
/// randomised, the list itself is shuffled first, so that chance decides which conditions occur once more often, and then every block.
std::vector<std::size_t> condition_order(const TrialPlan& plan, std::size_t trials, SplitMix64& random) {
  std::vector<std::size_t> turn(plan.conditions.size());
  std::iota(turn.begin(), turn.end(), std::size_t{0});
  const bool is_random = plan.order == TrialOrder::Randomised;
  if (is_random) random.shuffle(turn.begin(), turn.end());
  std::vector<std::size_t> order(trials);
  for (std::size_t index = 0; index < trials; ++index) order[index] = turn[index % turn.size()];
  for (std::size_t first = 0; is_random && first < trials; first += plan.trials_per_block) {
    const std::size_t last = std::min<std::size_t>(first + plan.trials_per_block, trials);
    random.shuffle(order.begin() + static_cast<std::ptrdiff_t>(first), order.begin() + static_cast<std::ptrdiff_t>(last));
  }
  return order;
}

tl::unexpected<core::Error> wrong_state(std::string what, std::string hint = {}) {
  return core::fail(core::ErrorCode::WrongState, std::move(what), std::move(hint));
}

}  // namespace

std::uint32_t planned_trials(const TrialPlan& plan) {
  if (plan.conditions.empty()) return 0;
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(std::uint64_t{plan.trials_per_block} * plan.blocks, kMostTrials));
}

std::optional<double> length_s(const TrialPlan& plan) {
  const std::uint32_t trials = planned_trials(plan);
  if (!(plan.duration_s > 0.0) || trials == 0) return std::nullopt;
  const double trial_s = 0.5 * (plan.cue_delay_min_s + plan.cue_delay_max_s) + plan.settle_s + plan.duration_s;
  const std::uint32_t blocks = (trials + plan.trials_per_block - 1) / plan.trials_per_block;
  return trials * trial_s + (trials - blocks) * plan.rest_s + (blocks - 1) * plan.block_rest_s;
}

std::vector<PlannedTrial> make_plan(const TrialPlan& plan, std::uint64_t seed) {
  const std::uint32_t wanted = planned_trials(plan);
  if (wanted == 0) return {};
  SplitMix64 random(seed);
  const auto order = condition_order(plan, wanted, random);
  std::vector<PlannedTrial> places;
  for (std::uint32_t index = 0; index < order.size(); ++index) {
    places.push_back({.trial = index + 1,
                      .block = index / plan.trials_per_block + 1,
                      .condition = order[index],
                      .cue_delay_s = cue_delay_s(plan, seed, index + 1, 1)});
  }
  return places;
}

std::string_view name(TrialPhase phase) noexcept {
  switch (phase) {
    case TrialPhase::Waiting: return "waiting";
    case TrialPhase::Ready: return "ready";
    case TrialPhase::Settling: return "settling";
    case TrialPhase::Measuring: return "measuring";
    case TrialPhase::Resting: return "resting";
    case TrialPhase::Finished: return "finished";
  }
  return "unknown";
}

std::string_view name(TrialEventKind kind) noexcept {
  switch (kind) {
    case TrialEventKind::Ready: return "ready";
    case TrialEventKind::Go: return "go";
    case TrialEventKind::Measure: return "measure";
    case TrialEventKind::Done: return "done";
    case TrialEventKind::Redone: return "redone";
    case TrialEventKind::Rejected: return "rejected";
    case TrialEventKind::Aborted: return "aborted";
    case TrialEventKind::Rest: return "rest";
    case TrialEventKind::Finished: return "finished";
    case TrialEventKind::Undone: return "undone";
  }
  return "unknown";
}

TrialRun::TrialRun(const TrialPlan& plan, std::uint64_t seed, const std::vector<std::pair<std::string, std::string>>& fields,
                   const std::vector<EarlierTrial>& earlier)
    : plan_(plan),
      seed_(seed),
      places_(make_plan(plan, seed)),
      is_done_before_(places_.size(), false),
      newest_attempts_(places_.size(), 0) {
  for (const Condition& condition : plan_.conditions) {
    targets_cm_.push_back(target_cm(condition, fields));
    targets_percent_.push_back(target_percent(condition, fields));
  }
  for (const EarlierTrial& one : earlier) {
    if (one.trial < 1 || one.trial > places_.size()) continue;
    is_done_before_[one.trial - 1] = one.is_done;
    newest_attempts_[one.trial - 1] = one.newest_attempt;
  }
  upcoming_ = first_open_from(0);
  if (upcoming_ == places_.size()) enter(TrialPhase::Finished, 0, std::nullopt);
}

core::Status TrialRun::next(std::int64_t now_ns) {
  tick(now_ns);
  if (has_ended_) return wrong_state("the session has ended");
  if (phase_ == TrialPhase::Finished) {
    return wrong_state("all " + std::to_string(places_.size()) + " trials of the plan are done", "end the session: dtsctl session stop");
  }
  if (phase_ == TrialPhase::Waiting || phase_ == TrialPhase::Resting) {
    before_.reset();
    start(upcoming_, now_ns);
  } else if (phase_ == TrialPhase::Measuring && !phase_ends_ns_) {
    end(now_ns);
  } else {
    return wrong_state("trial " + std::to_string(places_[*current_].trial) + " is under way (" + std::string(name(phase_)) + ")",
                       "wait until it ends; if it went wrong: dtsctl session trial redo or reject");
  }
  return {};
}

core::Status TrialRun::redo(std::int64_t now_ns) {
  tick(now_ns);
  DTS_TRY(check_voidable());
  keep_for_undo(now_ns);
  report(TrialEventKind::Redone, now_ns);
  start(*current_, now_ns);
  return {};
}

core::Status TrialRun::reject(std::int64_t now_ns) {
  tick(now_ns);
  DTS_TRY(check_voidable());
  keep_for_undo(now_ns);
  report(TrialEventKind::Rejected, now_ns);
  is_void_ = true;
  if (is_under_way()) {
    go_on(now_ns);
  } else if (plan_.starts_by_itself && phase_ == TrialPhase::Resting && *phase_ends_ns_ < undo_until_ns()) {
    rest(kUndoS, now_ns);  // the next trial must not start while the user may still take this back
  }
  return {};
}

core::Status TrialRun::undo(std::int64_t now_ns) {
  tick(now_ns);
  if (has_ended_) return wrong_state("the session has ended");
  if (!before_ || now_ns >= undo_until_ns()) {
    return wrong_state("no redo or reject can be taken back any more",
                       "an undo is possible for " + std::to_string(static_cast<int>(kUndoS)) + " s; continue: dtsctl session trial next");
  }
  const Before before = *std::exchange(before_, std::nullopt);
  phase_ = before.phase;
  phase_ends_ns_ = before.phase_ends_ns;
  upcoming_ = before.upcoming;
  attempt_ = before.attempt;
  last_ended_ = before.last_ended;
  is_void_ = false;
  report(TrialEventKind::Undone, now_ns);
  if (!phase_ends_ns_) return {};
  const std::int64_t left_ns = *phase_ends_ns_ - before.voided_ns;
  if (phase_ == TrialPhase::Ready) phase_ends_ns_ = now_ns + left_ns;
  if (phase_ == TrialPhase::Resting) rest(static_cast<double>(left_ns) * 1e-9, now_ns);
  catch_up(now_ns);
  tick(now_ns);
  return {};
}

/// Passes the ends of settling and measurement that were due while the attempt was void. What follows begins now, not in the past.
void TrialRun::catch_up(std::int64_t now_ns) {
  if (phase_ == TrialPhase::Settling && *phase_ends_ns_ <= now_ns) measure(*phase_ends_ns_);
  if (phase_ != TrialPhase::Measuring || !phase_ends_ns_ || *phase_ends_ns_ > now_ns) return;
  report(TrialEventKind::Done, *phase_ends_ns_);
  go_on(now_ns);
}

std::int64_t TrialRun::undo_until_ns() const noexcept { return before_ ? before_->voided_ns + nanoseconds(kUndoS) : 0; }

void TrialRun::keep_for_undo(std::int64_t now_ns) {
  before_ = Before{.voided_ns = now_ns,
                   .phase = phase_,
                   .phase_ends_ns = phase_ends_ns_,
                   .upcoming = upcoming_,
                   .attempt = attempt_,
                   .last_ended = last_ended_};
}

void TrialRun::abort(std::int64_t now_ns) {
  tick(now_ns);
  if (is_under_way()) report(TrialEventKind::Aborted, now_ns);
  before_.reset();
  has_ended_ = true;
  if (phase_ != TrialPhase::Finished) enter(TrialPhase::Waiting, now_ns, std::nullopt);
}

void TrialRun::tick(std::int64_t now_ns) {
  // Terminates: the plan has at most kMostTrials trials, each step continues in it, and a trial without a duration has no end to reach.
  while (phase_ends_ns_ && *phase_ends_ns_ <= now_ns) leave_phase(*phase_ends_ns_);
}

TrialView TrialRun::view(std::int64_t now_ns) const {
  TrialView view{.phase = phase_, .of = static_cast<std::uint32_t>(places_.size())};
  const bool has_upcoming = upcoming_ < places_.size();
  if (current_ || has_upcoming) {
    const PlannedTrial& shown = places_[current_.value_or(upcoming_)];
    view.block = shown.block;
    view.target_cm = targets_cm_[shown.condition];
    view.target_percent = targets_percent_[shown.condition];
    view.has_feedback = has_feedback(plan_.conditions[shown.condition]);
  }
  if (current_) {
    view.trial = places_[*current_].trial;
    view.attempt = attempt_;
    view.condition = plan_.conditions[places_[*current_].condition].name;
  }
  if (has_upcoming) {
    view.next_trial = places_[upcoming_].trial;
    view.next_condition = plan_.conditions[places_[upcoming_].condition].name;
    view.next_target_cm = targets_cm_[places_[upcoming_].condition];
    view.next_target_percent = targets_percent_[places_[upcoming_].condition];
  }
  if (phase_ends_ns_) view.remaining_s = std::max(0.0, static_cast<double>(*phase_ends_ns_ - now_ns) * 1e-9);
  view.settle_s = plan_.settle_s;
  view.duration_s = plan_.duration_s;
  view.last_ended = last_ended_;
  if (before_) view.undo_s = std::max(0.0, static_cast<double>(undo_until_ns() - now_ns) * 1e-9);
  return view;
}

std::vector<TrialEvent> TrialRun::take_events() { return std::exchange(events_, {}); }

bool TrialRun::is_under_way() const noexcept {
  return phase_ == TrialPhase::Ready || phase_ == TrialPhase::Settling || phase_ == TrialPhase::Measuring;
}

core::Status TrialRun::check_voidable() const {
  if (has_ended_) return wrong_state("the session has ended");
  if (!current_) return wrong_state("no trial has been started in this part of the session", "start one: dtsctl session trial next");
  if (!is_void_) return {};
  return wrong_state("trial " + std::to_string(places_[*current_].trial) + " is rejected already", "continue: dtsctl session trial next");
}

std::size_t TrialRun::first_open_from(std::size_t place) const noexcept {
  while (place < places_.size() && is_done_before_[place]) ++place;
  return place;
}

double TrialRun::rest_after_current_s() const noexcept {
  return places_[upcoming_].block != places_[*current_].block ? plan_.block_rest_s : plan_.rest_s;
}

void TrialRun::start(std::size_t place, std::int64_t at_ns) {
  current_ = place;
  upcoming_ = first_open_from(place + 1);
  attempt_ = ++newest_attempts_[place];
  is_void_ = false;
  report(TrialEventKind::Ready, at_ns);
  enter(TrialPhase::Ready, at_ns, cue_delay_s(plan_, seed_, places_[place].trial, attempt_));
}

void TrialRun::settle(std::int64_t at_ns) {
  report(TrialEventKind::Go, at_ns);
  enter(TrialPhase::Settling, at_ns, plan_.settle_s);
}

void TrialRun::measure(std::int64_t at_ns) {
  report(TrialEventKind::Measure, at_ns);
  // At least 1 ns: a duration that rounds to 0 would nest all trials of the plan in one call.
  enter(TrialPhase::Measuring, at_ns, plan_.duration_s > 0.0 ? std::optional(std::max(plan_.duration_s, 1e-9)) : std::nullopt);
}

/// Continues after a trial that is done or void. A plan that starts by itself rests at least as long as `undo` is possible.
void TrialRun::go_on(std::int64_t at_ns) {
  if (upcoming_ == places_.size()) {
    enter(TrialPhase::Finished, at_ns, std::nullopt);
    return;
  }
  const double undo_s = before_ && is_void_ && plan_.starts_by_itself ? static_cast<double>(undo_until_ns() - at_ns) * 1e-9 : 0.0;
  const double rest_s = std::max(rest_after_current_s(), undo_s);
  if (nanoseconds(rest_s) == 0) {
    stop_resting(at_ns);
    return;
  }
  rest(rest_s, at_ns);
}

/// Rests for `rest_s` from now on, also if a rest is under way.
void TrialRun::rest(double rest_s, std::int64_t at_ns) {
  report(TrialEventKind::Rest, at_ns);
  events_.back().rest_s = rest_s;
  enter(TrialPhase::Resting, at_ns, rest_s);
}

void TrialRun::stop_resting(std::int64_t at_ns) {
  if (plan_.starts_by_itself) {
    before_.reset();
    start(upcoming_, at_ns);
  } else {
    enter(TrialPhase::Waiting, at_ns, std::nullopt);
  }
}

void TrialRun::leave_phase(std::int64_t at_ns) {
  switch (phase_) {
    case TrialPhase::Ready: return settle(at_ns);
    case TrialPhase::Settling: return measure(at_ns);
    case TrialPhase::Measuring: end(at_ns); return;
    case TrialPhase::Resting: return stop_resting(at_ns);
    case TrialPhase::Waiting:
    case TrialPhase::Finished: break;
  }
  phase_ends_ns_.reset();
}

/// Enters a phase. Leaves a phase of length 0 immediately, without a call of `tick`.
void TrialRun::enter(TrialPhase phase, std::int64_t at_ns, std::optional<double> length_s) {
  phase_ = phase;
  phase_ends_ns_.reset();
  if (phase == TrialPhase::Finished) events_.push_back({.kind = TrialEventKind::Finished, .at_ns = at_ns});
  if (!length_s) return;
  phase_ends_ns_ = at_ns + nanoseconds(*length_s);
  if (*phase_ends_ns_ == at_ns) leave_phase(at_ns);
}

/// Ends the measurement. A redo that led to it is final now.
void TrialRun::end(std::int64_t at_ns) {
  before_.reset();
  report(TrialEventKind::Done, at_ns);
  go_on(at_ns);
}

void TrialRun::report(TrialEventKind kind, std::int64_t at_ns) {
  const PlannedTrial& place = places_[*current_];
  const Condition& condition = plan_.conditions[place.condition];
  events_.push_back({.kind = kind,
                     .trial = place.trial,
                     .attempt = attempt_,
                     .block = place.block,
                     .condition = condition.name,
                     .labels = condition.labels,
                     .target_cm = targets_cm_[place.condition],
                     .at_ns = at_ns});
  using enum TrialEventKind;
  if (kind == Done || kind == Redone || kind == Rejected || kind == Aborted) {
    last_ended_ = EndedAttempt{.outcome = kind, .trial = place.trial, .attempt = attempt_};
  }
}

}  // namespace dts::session
