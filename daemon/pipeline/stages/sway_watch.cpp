// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/sway_watch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/special_numbers.h"
#include "core/sway.h"

namespace dts::pipeline {
namespace {

constexpr double kCutOffHz = 10.0;
constexpr double kFarthestMm = 1e5;  // farther away is not on a plate
constexpr double kLargestLoadN = 1e6;
constexpr double kLoadTimes = 5.0;        // time constants of the load in the time of settling: its error is then below 1 %
constexpr double kLargestInFilter = 1e9;  // limit for values from a file
constexpr std::uint64_t kLargestIndex = std::uint64_t{1} << 53U;  // the largest that a state can hold

/// Returns whether both are the same attempt; the end may differ.
bool is_same(const SwayWatch::Trial& a, const SwayWatch::Trial& b) noexcept { return a.number == b.number && a.begin == b.begin; }

bool is_place(double ml_mm, double ap_mm) noexcept { return std::abs(ml_mm) <= kFarthestMm && std::abs(ap_mm) <= kFarthestMm; }

/// Keeps the newest events, because each contains more than the one before.
void push_newest(SwayWatch::Events& events, const core::SwayEvent& event) noexcept {
  if (events.count == events.events.size()) {
    std::ranges::move(events.events.begin() + 1, events.events.end(), events.events.begin());
    --events.count;
    ++events.lost;
  }
  events.push(event);
}

}  // namespace

void SwayWatch::prepare(const core::Rate& rate, double every_ms, double settle_ms) {
  const double hz = rate.hz();
  divisor_ = static_cast<std::uint64_t>(std::max(1.0, std::round(hz / kAnalysisRateHz)));
  const double analysis_hz = hz / static_cast<double>(divisor_);
  const auto samples = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::round(every_ms * 1e-3 * analysis_hz)));
  every_ = samples * divisor_;
  settle_ = settle_ms > 0.0 ? rate.scans_in_ms(settle_ms) : 0;
  load_step_ = settle_ > 0 ? 1.0 - std::exp(-kLoadTimes / static_cast<double>(settle_)) : 0.0;
  longest_gap_ = static_cast<std::uint64_t>(std::floor(kLongestGapMs * 1e-3 * hz + 1e-6));  // five samples also at 99.999999 Hz
  lag_ = static_cast<std::uint64_t>(std::round(static_cast<double>(kPasses) * posturography::lag_near_dc(kCutOffHz, hz)));
  const posturography::LowPass low_pass = posturography::butterworth4(kCutOffHz, hz);
  ml_filter_.fill(posturography::CausalLowPass(low_pass));
  ap_filter_.fill(posturography::CausalLowPass(low_pass));
  longest_transient_ = rate.scans_in_ms(kLongestTransientMs);
  sums_ = voided_sums_ = posturography::RunningSwaySums(analysis_hz);
  const double most_samples = core::kRecentSwayS * analysis_hz + 1e-6;  // 3000 also at 99.999999 Hz
  recent_ = posturography::RecentSwaySums(analysis_hz, static_cast<std::size_t>(most_samples / static_cast<double>(samples)));
  trial_ = {};
  reset();
}

void SwayWatch::expect(const Trial& trial, Events& events) noexcept {
  if (!is_same(trial, trial_)) {
    const bool is_undone = trial.number != 0 && is_same(trial, voided_);
    if (trial_.number != 0 && !is_undone) make_void();
    if (window_ == Window::OfTrial) close(events);
    if (is_undone) {
      resume();
    } else if (trial.number != 0) {
      restart(events);
    }
  }
  trial_ = trial;
}

/// Keeps the window of the trial, in case that a redo or reject ended it and is undone.
void SwayWatch::make_void() noexcept {
  voided_ = trial_;
  voided_first_ = window_ == Window::OfTrial ? first_ : 0;
  voided_sums_ = sums_;
}

void SwayWatch::restart(Events& events) noexcept {
  if (window_ == Window::Free) close(events);
}

void SwayWatch::process(std::uint64_t now, const Sample& sample, Events& events) noexcept {
  if (!is_place(sample.ml_mm, sample.ap_mm)) return miss(now, events);
  if (!is_standing_) settle(now, sample);
  if (gap_ > 0) bridge(now, sample, events);
  measure(now, sample, events);
  last_ml_mm_ = sample.ml_mm;
  last_ap_mm_ = sample.ap_mm;
}

void SwayWatch::miss(std::uint64_t now, Events& events) noexcept {
  if (!is_standing_) return follow_trial(now, events);
  if (++gap_ > longest_gap_) lose(now, events);
}

/// Fills a short gap by linear interpolation.
void SwayWatch::bridge(std::uint64_t now, const Sample& sample, Events& events) noexcept {
  const std::uint64_t missing = gap_;
  const auto steps = static_cast<double>(missing + 1);
  for (std::uint64_t k = 1; k <= missing; ++k) {
    const double part = static_cast<double>(k) / steps;
    measure(now - missing + k - 1,
            {.ml_mm = last_ml_mm_ + part * (sample.ml_mm - last_ml_mm_),
             .ap_mm = last_ap_mm_ + part * (sample.ap_mm - last_ap_mm_),
             .load_n = core::kNaN},
            events);
  }
  gap_ = 0;
}

void SwayWatch::settle(std::uint64_t now, const Sample& sample) noexcept {
  is_standing_ = true;
  since_ = loaded_since_ = still_since_ = now;
  first_load_n_ = steady_load_n_ = 0.0;
  still_ml_mm_ = sample.ml_mm;
  still_ap_mm_ = sample.ap_mm;
  for (posturography::CausalLowPass& pass : ml_filter_) pass.settle_at(sample.ml_mm);
  for (posturography::CausalLowPass& pass : ap_filter_) pass.settle_at(sample.ap_mm);
}

/// Detects that a foot came on the plate or left it.
void SwayWatch::check_load(std::uint64_t now, double load_n, Events& events) noexcept {
  if (!(load_n > 0.0 && load_n < kLargestLoadN)) return;  // unknown
  const bool is_settling = now < loaded_since_ + settle_;
  const double reference_n = is_settling ? first_load_n_ : steady_load_n_;
  if (std::abs(load_n - reference_n) <= kSteadyLoad * reference_n) {
    if (is_settling) steady_load_n_ += load_step_ * (load_n - steady_load_n_);
    return;
  }
  if (reference_n > 0.0) {
    loaded_since_ = now;
    restart(events);
  }
  first_load_n_ = steady_load_n_ = load_n;
}

void SwayWatch::check_place(std::uint64_t described, double ml_mm, double ap_mm) noexcept {
  if (std::abs(ml_mm - still_ml_mm_) <= kSteadyMm && std::abs(ap_mm - still_ap_mm_) <= kSteadyMm) return;
  still_since_ = described;
  still_ml_mm_ = ml_mm;
  still_ap_mm_ = ap_mm;
}

bool SwayWatch::is_still(std::uint64_t described) const noexcept {
  if (described < loaded_since_ + settle_) return false;
  return described >= still_since_ + settle_ || described >= loaded_since_ + longest_transient_;
}

/// The gap is too long to be bridged: the person left the plate when it began.
void SwayWatch::lose(std::uint64_t now, Events& events) noexcept {
  const std::uint64_t missing = gap_;
  is_standing_ = false;
  since_ = gap_ = 0;
  if (window_ == Window::Free) close(events);
  sums_.interrupt();
  voided_sums_.interrupt();
  for (std::uint64_t k = 1; k <= missing; ++k) follow_trial(now - missing + k, events);
}

void SwayWatch::measure(std::uint64_t now, const Sample& sample, Events& events) noexcept {
  double ml_mm = sample.ml_mm;
  double ap_mm = sample.ap_mm;
  for (posturography::CausalLowPass& pass : ml_filter_) ml_mm = pass.step(ml_mm);
  for (posturography::CausalLowPass& pass : ap_filter_) ap_mm = pass.step(ap_mm);
  check_load(now, sample.load_n, events);
  if (now - since_ < lag_) return;  // describes a time before the person stood there
  const std::uint64_t described = now - lag_;
  follow_trial(described, events);
  check_place(described, ml_mm, ap_mm);
  if (window_ == Window::None && is_still(described)) open(Window::Free, described);
  if (window_ == Window::OfTrial && (described - first_) % divisor_ == 0) sums_.add(ml_mm, ap_mm);
  if (has_voided_begun() && described < voided_.end && (described - voided_first_) % divisor_ == 0) voided_sums_.add(ml_mm, ap_mm);
  if (window_ == Window::None || (described - first_) % divisor_ != 0) return;
  if (window_ == Window::Free) recent_.add(ml_mm, ap_mm, described);
  newest_ = described;
  has_news_ = true;
  if (described >= due_) report(events);
}

bool SwayWatch::has_voided_begun() const noexcept { return voided_.number != 0 && voided_first_ >= voided_.begin; }

void SwayWatch::follow_trial(std::uint64_t described, Events& events) noexcept {
  if (!has_voided_begun() && described >= voided_.begin && described < voided_.end) voided_first_ = described;
  if (window_ == Window::OfTrial && described >= trial_.end) close(events);
  if (window_ == Window::OfTrial || trial_.number == 0 || described < trial_.begin || described >= trial_.end) return;
  if (window_ == Window::Free) close(events);
  open(Window::OfTrial, described);
}

void SwayWatch::open(Window window, std::uint64_t described) noexcept {
  window_ = window;
  first_ = newest_ = described;
  due_ = described + every_ - divisor_;  // so that a chunk has the same number of samples as all others
  has_news_ = false;
  sums_.reset();
  recent_.reset();
}

/// Continues the window of the voided trial, if it has begun. Its values follow with the next sample.
void SwayWatch::resume() noexcept {
  if (has_voided_begun()) {
    open(Window::OfTrial, voided_first_);
    due_ = first_;
    sums_ = voided_sums_;
  }
  voided_ = {};
}

void SwayWatch::close(Events& events) noexcept {
  if (has_news_) report(events);
  open(Window::None, 0);
  due_ = 0;
}

void SwayWatch::report(Events& events) noexcept {
  core::SwayEvent event;
  event.scan = core::ScanIndex{newest_};
  const bool is_trial = window_ == Window::OfTrial;
  event.first_scan = core::ScanIndex{is_trial ? first_ : recent_.first_index()};
  event.trial = is_trial ? trial_.number : 0;
  event.values = is_trial ? sums_.values() : recent_.values();
  if (event.values.samples > 0) push_newest(events, event);  // none: restored from a recording of dtsd 0.1
  recent_.end_chunk();
  has_news_ = false;
  due_ = first_ + ((newest_ + divisor_ - first_) / every_ + 1) * every_ - divisor_;
}

void SwayWatch::reset() noexcept {
  is_standing_ = false;
  since_ = gap_ = loaded_since_ = still_since_ = 0;
  last_ml_mm_ = last_ap_mm_ = first_load_n_ = steady_load_n_ = still_ml_mm_ = still_ap_mm_ = 0.0;
  for (posturography::CausalLowPass& pass : ml_filter_) pass.set_state({});
  for (posturography::CausalLowPass& pass : ap_filter_) pass.set_state({});
  voided_ = {};
  voided_first_ = 0;
  voided_sums_.reset();
  open(Window::None, 0);
  due_ = 0;
}

void SwayWatch::save(StateWriter& writer) const noexcept {
  writer.put(is_standing_ ? 1.0 : 0.0);
  writer.put_count(since_);
  writer.put_count(gap_);
  writer.put(last_ml_mm_);
  writer.put(last_ap_mm_);
  for (const Filter* const filter : {&ml_filter_, &ap_filter_}) {
    for (const posturography::CausalLowPass& pass : *filter) {
      for (const double number : pass.state()) writer.put(number);
    }
  }
  writer.put_count(static_cast<std::uint64_t>(window_));
  writer.put_count(first_);
  writer.put_count(due_);
  writer.put_count(newest_);
  writer.put(has_news_ ? 1.0 : 0.0);
  for (const double number : sums_.state()) writer.put(number);
  writer.put_count(loaded_since_);
  writer.put(steady_load_n_);
  writer.put_count(still_since_);
  writer.put(still_ml_mm_);
  writer.put(still_ap_mm_);
  recent_.save(writer.take(recent_.state_size()));
  writer.put_count(voided_.number);
  writer.put_count(voided_.begin);
  writer.put_count(std::min(voided_.end, kLargestIndex));
  writer.put_count(voided_first_);
  for (const double number : voided_sums_.state()) writer.put(number);
  writer.put(first_load_n_);
}

bool SwayWatch::restore(StateReader& reader, const Trial& trial) noexcept {
  trial_ = trial;
  is_standing_ = reader.flag();
  since_ = reader.count(kLargestIndex);
  gap_ = reader.count(longest_gap_);
  last_ml_mm_ = reader.number(-kFarthestMm, kFarthestMm);
  last_ap_mm_ = reader.number(-kFarthestMm, kFarthestMm);
  for (Filter* const filter : {&ml_filter_, &ap_filter_}) {
    for (posturography::CausalLowPass& pass : *filter) {
      std::array<double, posturography::CausalLowPass::kStateSize> state{};
      for (double& number : state) number = reader.number(-kLargestInFilter, kLargestInFilter);
      pass.set_state(state);
    }
  }
  window_ = static_cast<Window>(reader.count(static_cast<std::uint64_t>(Window::OfTrial)));
  first_ = reader.count(kLargestIndex);
  due_ = reader.count(kLargestIndex);
  newest_ = reader.count(kLargestIndex);
  has_news_ = reader.flag();
  std::array<double, posturography::RunningSwaySums::kStateSize> sums{};
  for (double& number : sums) number = reader.any();
  loaded_since_ = reader.count(kLargestIndex);
  steady_load_n_ = reader.number(0.0, kLargestLoadN);
  still_since_ = reader.count(kLargestIndex);
  still_ml_mm_ = reader.number(-kLargestInFilter, kLargestInFilter);
  still_ap_mm_ = reader.number(-kLargestInFilter, kLargestInFilter);
  const bool is_recent_possible = recent_.restore(reader.take(recent_.state_size()));
  voided_.number = static_cast<std::uint32_t>(reader.count(std::numeric_limits<std::uint32_t>::max()));
  voided_.begin = reader.count(kLargestIndex);
  voided_.end = reader.count(kLargestIndex);
  voided_first_ = reader.count(kLargestIndex);
  std::array<double, posturography::RunningSwaySums::kStateSize> voided_sums{};
  for (double& number : voided_sums) number = reader.any();
  first_load_n_ = reader.number(0.0, kLargestLoadN);
  const bool are_sums_possible = sums_.set_state(sums) && voided_sums_.set_state(voided_sums);
  const bool has_its_trial = window_ != Window::OfTrial || trial_.number != 0;
  const bool is_window_possible = newest_ >= first_ && (window_ != Window::Free || is_standing_) && (gap_ == 0 || is_standing_);
  if (reader.is_right() && is_recent_possible && are_sums_possible && has_its_trial && is_window_possible) return true;
  reset();
  return false;
}

}  // namespace dts::pipeline
