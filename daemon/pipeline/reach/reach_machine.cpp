// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/reach_machine.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dts::pipeline {
namespace {

namespace flag = core::reach_flag;

// Reach-model section 5; times in s.
constexpr double kSeatedMm = 0.8;
constexpr double kLeftMm = 0.5;  // lower than kSeatedMm, because a child's dip may go below that
constexpr double kLeftS = 0.1;
constexpr double kCrossS = 0.06;
constexpr double kOnsetBackS = 0.5;
constexpr double kCancelS = 0.25;
constexpr double kLongestDipS = 3.0;
constexpr double kLongestRiseS = 6.0;
constexpr double kLongestReturnS = 6.0;
constexpr double kNoHigherS = 0.6;
constexpr double kReturnedS = 0.3;
constexpr double kStoppedS = 0.03;  // time without a new extreme before it is reported
constexpr double kFallPart = 0.25;
constexpr double kResumePart = 0.10;
constexpr double kWentBackPart = 0.5;
constexpr double kHigherPart = 0.02;  // a later peak that is higher by less belongs to the same one
constexpr double kTellPart = 0.005;
constexpr double kDoubtfulS = 0.05;  // of substituted values; a single dropped sample does no harm
constexpr double kRememberedS = 0.6;
constexpr double kSteadyS = 1.0;
constexpr double kPauseS = 0.15;  // after a rest of this length, everything earlier belongs to the previous reach

}  // namespace

void ReachMachine::prepare(double rate_hz, const SeatLimits& limits) noexcept {
  rate_hz_ = rate_hz;
  limits_ = limits;
  rest_.prepare(rate_hz);
  reset();
}

void ReachMachine::step(const ReachSample& sample, Events& events) noexcept {
  history_.push(sample.mm);
  count_doubts(sample);
  if (state_ != State::Absent && has_left(sample)) return leave(sample, events);
  switch (state_) {
    case State::Absent:
      if (sample.is_known && sample.mm > kSeatedMm) enter(State::Settle);
      break;
    case State::Settle: settle(sample, events); break;
    case State::Quiet: watch_rest(sample, events); break;
    case State::Ris: find_lowest(sample, events); break;
    case State::Rise: find_highest(sample, events); break;
    case State::Return: await_return(sample, events); break;
  }
}

void ReachMachine::enter(State state) noexcept {
  if (state == State::Settle) rest_.restart(state_ == State::Absent);
  state_ = state;
  below_ = above_ = back_ = light_ = 0;
  is_reported_ = false;
  is_between_ = false;
}

/// Increases while a doubt persists. At rest, it fades within 0.6 s; during a reach it stays.
void ReachMachine::count_doubts(const ReachSample& sample) noexcept {
  const bool is_fading = state_ <= State::Quiet;
  const auto count = [&](std::uint64_t& doubts, bool is_doubtful) {
    if (is_doubtful) {
      doubts = std::min(doubts + 1, ticks(kRememberedS));
    } else if (is_fading && doubts > 0) {
      --doubts;
    }
  };
  count(substituted_, sample.is_substituted);
  count(at_end_, sample.is_at_end);
  is_untared_ = sample.is_untared || (is_untared_ && !is_fading);
}

bool ReachMachine::has_left(const ReachSample& sample) noexcept {
  if (!sample.is_known) return true;
  light_ = sample.mm < kLeftMm ? light_ + 1 : 0;
  return light_ >= ticks(kLeftS);
}

void ReachMachine::leave(const ReachSample& sample, Events& events) noexcept {
  const bool has_stood_up = sample.is_known;
  if (state_ == State::Ris || (state_ == State::Rise && !is_final_ && !has_stood_up)) {
    reach_.flags |= has_stood_up ? flag::kStoodUp : std::uint16_t{0};
    cancel(events);
  } else if ((state_ == State::Rise || state_ == State::Return) && has_stood_up) {
    finish(flag::kStoodUp, events);
  }
  enter(State::Absent);
}

/// Back-to-back reaches: without a rest in between, uses the rest before the first reach, if the rise is larger than a wobble.
void ReachMachine::settle(const ReachSample& sample, Events& events) noexcept {
  if (is_between_) {
    const bool is_at_rest = is_back(sample, reach_.threshold_mm, kPauseS);
    if (is_at_rest) history_.forget_before(now() - ticks(kPauseS) + 1);
    if (is_at_rest || sample.mm < between_.mm) between_ = {.tick = now(), .mm = sample.mm};
    const double limit_mm = std::max(4.0 * reach_.threshold_mm, 2.0 * kMinorPart * reach_.rest_mm);
    const double from_mm = std::max(between_.mm, reach_.rest_mm);
    above_ = sample.mm > from_mm + limit_mm ? above_ + 1 : 0;
    if (above_ >= ticks(kCrossS)) return open_again(events, sample);
  }
  if (rest_.settle(sample)) rest_until(now());
}

/// The rest is known. Ignores everything before it for the next reach: an empty seat, or another movement.
void ReachMachine::rest_until(std::uint64_t tick) noexcept {
  history_.forget_before(tick - std::min(tick, rest_.length()) + 1);
  enter(State::Quiet);
}

void ReachMachine::open_again(Events& events, const ReachSample& sample) noexcept {
  const ReachRecord before = reach_;
  const TickPoint lowest = between_;
  reach_ = {.rest_mm = before.rest_mm,
            .spread_mm = before.spread_mm,
            .threshold_mm = before.threshold_mm,
            .rest_ratio = before.rest_ratio,
            .rest_twist = before.rest_twist};
  reach_.flags = flag::kBaselineUncertain;
  ++number_;
  is_final_ = false;
  started_ = now();
  const bool has_dip = lowest.mm < reach_.rest_mm - reach_.threshold_mm;
  reach_.flags |= has_dip ? std::uint16_t{0} : flag::kNoInitiation;
  const std::uint64_t back = ticks(kOnsetBackS);
  const double limit_mm = std::max(1.5 * reach_.spread_mm, 0.15 * reach_.threshold_mm);
  reach_.p1_tick =
      has_dip ? find_onset(history_, lowest.tick, lowest.tick > back ? lowest.tick - back : 1, reach_.rest_mm, limit_mm) : lowest.tick;
  reach_.lowest = has_dip ? lowest : TickPoint{.tick = lowest.tick, .mm = reach_.rest_mm};
  report(core::ReachStep::P1, events);
  begin_rise(sample, events);
}

void ReachMachine::watch_rest(const ReachSample& sample, Events& events) noexcept {
  rest_.track(sample);
  const double off_mm = sample.mm - rest_.level_mm();
  below_ = off_mm < -rest_.threshold_mm() ? below_ + 1 : 0;
  above_ = off_mm > rest_.threshold_mm() ? above_ + 1 : 0;
  if (std::max(below_, above_) >= ticks(kCrossS)) open(sample, below_ > 0, events);
}

void ReachMachine::open(const ReachSample& sample, bool is_falling, Events& events) noexcept {
  reach_ = {.rest_mm = rest_.level_mm(),
            .spread_mm = rest_.spread_mm(),
            .threshold_mm = rest_.threshold_mm(),
            .rest_ratio = rest_.ratio(),
            .rest_twist = rest_.twist()};
  reach_.flags = rest_.is_uncertain() ? flag::kBaselineUncertain : std::uint16_t{0};
  ++number_;
  is_final_ = false;
  started_ = now();
  const double limit_mm = std::max(1.5 * reach_.spread_mm, 0.15 * reach_.threshold_mm);
  const std::uint64_t back = ticks(kOnsetBackS);
  reach_.p1_tick = find_onset(history_, now(), now() > back ? now() - back : 1, reach_.rest_mm, limit_mm);
  reach_.lowest = {.tick = reach_.p1_tick, .mm = reach_.rest_mm};
  report(core::ReachStep::P1, events);
  enter(State::Ris);
  if (is_falling) {
    reach_.lowest = {.tick = now(), .mm = sample.mm};
  } else {
    reach_.flags |= flag::kNoInitiation;
    begin_rise(sample, events);
  }
}

void ReachMachine::find_lowest(const ReachSample& sample, Events& events) noexcept {
  if (sample.mm < reach_.lowest.mm) reach_.lowest = {.tick = now(), .mm = sample.mm};
  if (sample.mm > reach_.rest_mm + reach_.threshold_mm) return begin_rise(sample, events);
  const bool is_shallow = reach_.dip_mm() < 2.0 * reach_.threshold_mm;
  if (is_back(sample, reach_.threshold_mm, kCancelS) && is_shallow) return cancel(events);
  if (now() - started_ > ticks(kLongestDipS) || (now() - started_ > ticks(kSteadyS) && is_steady())) {
    reach_.highest = {.tick = now(), .mm = sample.mm};
    reach_.ratio_at_highest = sample.ratio;
    const bool was_at_rest = (reach_.flags & flag::kBaselineUncertain) == 0;  // otherwise the fall may be the end of a movement
    was_at_rest ? finish(flag::kDipOnly, events) : cancel(events);
    return rest_anew(sample);
  }
  const bool has_stopped = now() - reach_.lowest.tick == ticks(kStoppedS) && reach_.dip_mm() > reach_.threshold_mm;
  if (!has_stopped || (is_reported_ && reported_mm_ - reach_.lowest.mm < 0.3 * reach_.threshold_mm)) return;
  is_reported_ = true;
  reported_mm_ = reach_.lowest.mm;
  report(core::ReachStep::P2, events);
}

void ReachMachine::begin_rise(const ReachSample& sample, Events& events) noexcept {
  if (!is_reported_ || reported_mm_ != reach_.lowest.mm) report(core::ReachStep::P2, events);
  reach_.highest = {.tick = now(), .mm = sample.mm};
  reach_.ratio_at_highest = sample.ratio;
  enter(State::Rise);
}

void ReachMachine::find_highest(const ReachSample& sample, Events& events) noexcept {
  if (sample.mm > reach_.highest.mm) {
    reach_.highest = {.tick = now(), .mm = sample.mm};
    reach_.ratio_at_highest = sample.ratio;
  }
  if (!is_final_ && is_false_rise(sample, events)) return;
  const bool is_too_long = now() - started_ > ticks(kLongestRiseS);
  if (is_too_long || has_passed_highest(sample)) {
    finish(is_too_long ? flag::kTimeout : std::uint16_t{0}, events);
    return enter(is_too_long ? State::Settle : State::Return);
  }
  const bool has_stopped = now() - reach_.highest.tick == ticks(kStoppedS);
  const double least_mm = std::max(0.1 * reach_.threshold_mm, kTellPart * reach_.swing_mm());
  if (!has_stopped || (is_reported_ && reach_.highest.mm - reported_mm_ < least_mm)) return;
  is_reported_ = true;
  reported_mm_ = reach_.highest.mm;
  report(core::ReachStep::P3, events);
}

/// Returns whether the rise is no reach: a small rise that falls below rest is a wobble before the initiation stage (reach-model section
/// 5).
bool ReachMachine::is_false_rise(const ReachSample& sample, Events& events) noexcept {
  const bool is_small = reach_.rise_mm() < std::max(4.0 * reach_.threshold_mm, kMinorPart * reach_.rest_mm);
  if (is_small && sample.mm < reach_.rest_mm - reach_.threshold_mm) {
    const double limit_mm = std::max(1.5 * reach_.spread_mm, 0.15 * reach_.threshold_mm);
    const std::uint64_t back = ticks(kOnsetBackS);
    reach_.p1_tick = find_onset(history_, now(), now() > back ? now() - back : 1, reach_.rest_mm, limit_mm);
    reach_.flags &= static_cast<std::uint16_t>(~flag::kNoInitiation);
    reach_.lowest = {.tick = now(), .mm = sample.mm};
    started_ = now();
    report(core::ReachStep::P1, events);
    enter(State::Ris);
    return true;
  }
  if (is_back(sample, reach_.threshold_mm, kCancelS) && reach_.rise_mm() < 2.0 * reach_.threshold_mm) {
    cancel(events);
    return true;
  }
  return false;
}

bool ReachMachine::has_passed_highest(const ReachSample& sample) const noexcept {
  const double fallen_mm = reach_.highest.mm - sample.mm;
  const bool has_fallen = fallen_mm > kFallPart * reach_.swing_mm() && fallen_mm >= 0.7 * reach_.threshold_mm;
  return has_fallen || now() - reach_.highest.tick >= ticks(kNoHigherS);
}

void ReachMachine::await_return(const ReachSample& sample, Events& events) noexcept {
  const double higher_mm = sample.mm - reach_.highest.mm;
  if (higher_mm > std::max(kHigherPart * reach_.swing_mm(), 0.3 * reach_.threshold_mm)) {
    const bool went_back = reach_.highest.mm - lowest_since(reach_.highest.tick) > kWentBackPart * reach_.swing_mm();
    if (went_back || higher_mm > kResumePart * reach_.swing_mm() || now() - reach_.highest.tick > ticks(kNoHigherS)) {
      reach_.flags |= flag::kResumed;
      if (reach_.resumed < std::numeric_limits<std::uint16_t>::max()) ++reach_.resumed;
    }
    started_ = now();
    reach_.highest = {.tick = now(), .mm = sample.mm};
    reach_.ratio_at_highest = sample.ratio;
    return enter(State::Rise);
  }
  // A wobble followed by the dip of a reach: the rest is unchanged.
  const bool was_minor = reach_.rise_mm() < kMinorPart * reach_.rest_mm;
  const bool was_small = reach_.rise_mm() < 2.0 * kMinorPart * reach_.rest_mm;
  below_ = was_minor && sample.mm < reach_.rest_mm - reach_.threshold_mm ? below_ + 1 : 0;
  if (below_ >= ticks(kCrossS)) return open(sample, true, events);
  if (is_back(sample, std::max(kFallPart * reach_.rise_mm(), reach_.threshold_mm), kReturnedS)) {
    enter(was_minor ? State::Quiet : State::Settle);
    is_between_ = !was_minor;
    between_ = {.tick = now(), .mm = sample.mm};
    return;
  }
  if (was_small && now() - reach_.highest.tick > ticks(kSteadyS) && is_steady()) return rest_anew(sample);
  if (now() - reach_.highest.tick <= ticks(kLongestReturnS)) return;
  finish(flag::kTimeout, events);
  rest_anew(sample);
}

double ReachMachine::lowest_since(std::uint64_t tick) const noexcept {
  double lowest_mm = history_.at(now());
  for (std::uint64_t k = std::max(tick, history_.oldest()); k < now(); ++k) lowest_mm = std::min(lowest_mm, history_.at(k));
  return lowest_mm;
}

bool ReachMachine::is_steady() const noexcept {
  double lowest_mm = history_.at(history_.now());
  double highest_mm = lowest_mm;
  for (std::uint64_t ago = 0; ago < std::min(ticks(kSteadyS), history_.now()); ++ago) {
    lowest_mm = std::min(lowest_mm, history_.at(history_.now() - ago));
    highest_mm = std::max(highest_mm, history_.at(history_.now() - ago));
  }
  return highest_mm - lowest_mm < RestDetector::steady_mm(lowest_mm);
}

/// The person's posture has changed: forgets what was known of the rest. If the last samples are steady, they are the new rest.
void ReachMachine::rest_anew(const ReachSample& sample) noexcept {
  rest_.forget_session();
  enter(State::Settle);
  ReachSample past = sample;
  for (std::uint64_t ago = RestDetector::kWindow; ago-- > 0 && state_ == State::Settle;) {
    past.mm = history_.at(history_.now() - std::min(ago, history_.now()));
    if (rest_.settle(past)) rest_until(now() - std::min(ago, now()));
  }
}

bool ReachMachine::is_back(const ReachSample& sample, double limit_mm, double seconds) noexcept {
  back_ = std::abs(sample.mm - reach_.rest_mm) < limit_mm ? back_ + 1 : 0;
  return back_ >= ticks(seconds);
}

void ReachMachine::cancel(Events& events) noexcept {
  report(core::ReachStep::Cancelled, events);
  enter(State::Quiet);
}

void ReachMachine::finish(std::uint16_t flags, Events& events) noexcept {
  reach_.flags |= flags;
  reach_.flags |= substituted_ >= ticks(kDoubtfulS) ? flag::kSubstituted : std::uint16_t{0};
  reach_.flags |= at_end_ >= ticks(kDoubtfulS) ? flag::kSaturated : std::uint16_t{0};
  reach_.flags |= is_untared_ ? flag::kUntared : std::uint16_t{0};
  if (!is_final_) find_shallow_dip(reach_, history_, rate_hz_);
  refine_onset(reach_, history_, rate_hz_);
  if (!is_final_) rest_.remember();
  is_final_ = true;
  report(core::ReachStep::Final, events);
}

void ReachMachine::report(core::ReachStep step, Events& events) const noexcept {
  core::ReachEvent event{.step = step, .number = number_, .flags = reach_.flags, .resumed = reach_.resumed};
  event.scan = core::ScanIndex{now()};
  event.p1 = {.scan = core::ScanIndex{reach_.p1_tick}, .value_mm = reach_.rest_mm};
  event.features.p1_mm = reach_.rest_mm;
  if (step != core::ReachStep::P1) {
    event.p2 = {.scan = core::ScanIndex{reach_.lowest.tick}, .value_mm = reach_.lowest.mm};
    event.features.p2_mm = reach_.lowest.mm;
  }
  if (step == core::ReachStep::P3 || step == core::ReachStep::Final) {
    event.p3 = {.scan = core::ScanIndex{reach_.highest.tick}, .value_mm = reach_.highest.mm};
    event.features.p3_mm = reach_.highest.mm;
  }
  if (step == core::ReachStep::Final) {
    event.features = features_of(reach_, history_, rate_hz_);
    event.flags |= doubts_of(event.features, limits_);
  }
  events.push(event);
}

void ReachMachine::reset() noexcept {
  history_.reset();
  rest_.reset();
  reach_ = {};
  state_ = State::Absent;
  number_ = 0;
  is_final_ = is_reported_ = is_untared_ = is_between_ = false;
  between_ = {};
  below_ = above_ = back_ = light_ = started_ = substituted_ = at_end_ = 0;
  reported_mm_ = 0.0;
}

template <class Self, class Archive>
void ReachMachine::exchange(Self& self, Archive& archive) noexcept {
  constexpr std::uint64_t kMostScans = std::uint64_t{1} << 52U;
  TransientHistory::exchange(self.history_, archive);
  ReachRecord::exchange(self.reach_, archive);
  archive.count(self.state_, static_cast<std::uint64_t>(State::Return));
  archive.count(self.number_, std::numeric_limits<std::uint32_t>::max());
  archive.flag(self.is_final_);
  archive.count(self.below_, kMostScans);
  archive.count(self.above_, kMostScans);
  archive.count(self.back_, kMostScans);
  archive.count(self.light_, kMostScans);
  archive.count(self.started_, kMostScans);
  archive.number(self.reported_mm_, -kMostStateMm, kMostStateMm);
  archive.flag(self.is_reported_);
  archive.count(self.substituted_, kMostScans);
  archive.count(self.at_end_, kMostScans);
  archive.flag(self.is_untared_);
  archive.flag(self.is_between_);
  archive.count(self.between_.tick, kMostScans);
  archive.number(self.between_.mm, -kMostStateMm, kMostStateMm);
}

void ReachMachine::save(StateWriter& writer) const noexcept {
  StateSaver saver(writer);
  exchange(*this, saver);
  rest_.save(writer);
}

void ReachMachine::restore(StateReader& reader) noexcept {
  StateLoader loader(reader);
  exchange(*this, loader);
  rest_.restore(reader);
}

}  // namespace dts::pipeline
