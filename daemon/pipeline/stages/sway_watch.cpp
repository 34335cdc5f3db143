// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/sway_watch.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dts::pipeline {
namespace {

constexpr double kCutOffHz = 10.0;
constexpr double kFarthestMm = 1e5;                               // farther away is not on a plate
constexpr double kLargestInFilter = 1e9;                          // limit for values from a file
constexpr std::uint64_t kLargestIndex = std::uint64_t{1} << 53U;  // the largest that a state can hold

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

void SwayWatch::prepare(const core::Rate& rate, double every_ms, double settle_ms) noexcept {
  const double hz = rate.hz();
  divisor_ = static_cast<std::uint64_t>(std::max(1.0, std::round(hz / kAnalysisRateHz)));
  every_ = rate.scans_in_ms(every_ms);
  settle_ = settle_ms > 0.0 ? rate.scans_in_ms(settle_ms) : 0;
  longest_gap_ = static_cast<std::uint64_t>(std::floor(kLongestGapMs * 1e-3 * hz + 1e-6));  // five samples also at 99.999999 Hz
  lag_ = static_cast<std::uint64_t>(std::round(static_cast<double>(kPasses) * posturography::lag_near_dc(kCutOffHz, hz)));
  const posturography::LowPass low_pass = posturography::butterworth4(kCutOffHz, hz);
  ml_filter_.fill(posturography::CausalLowPass(low_pass));
  ap_filter_.fill(posturography::CausalLowPass(low_pass));
  sums_ = posturography::RunningSwaySums(hz / static_cast<double>(divisor_));
  trial_ = {};
  reset();
}

void SwayWatch::expect(const Trial& trial, Events& events) noexcept {
  const bool goes_on = trial.number == trial_.number && trial.begin == trial_.begin;  // the end may differ
  if (window_ == Window::OfTrial && !goes_on) close(events);
  trial_ = trial;
}

void SwayWatch::process(std::uint64_t now, double ml_mm, double ap_mm, Events& events) noexcept {
  if (!is_place(ml_mm, ap_mm)) return miss(now, events);
  if (!is_standing_) settle(now, ml_mm, ap_mm);
  if (gap_ > 0) bridge(now, ml_mm, ap_mm, events);
  measure(now, ml_mm, ap_mm, events);
  last_ml_mm_ = ml_mm;
  last_ap_mm_ = ap_mm;
}

void SwayWatch::miss(std::uint64_t now, Events& events) noexcept {
  if (!is_standing_) return follow_trial(now, events);
  if (++gap_ > longest_gap_) lose(now, events);
}

/// Fills a short gap by linear interpolation.
void SwayWatch::bridge(std::uint64_t now, double ml_mm, double ap_mm, Events& events) noexcept {
  const std::uint64_t missing = gap_;
  const auto steps = static_cast<double>(missing + 1);
  for (std::uint64_t k = 1; k <= missing; ++k) {
    const double part = static_cast<double>(k) / steps;
    measure(now - missing + k - 1, last_ml_mm_ + part * (ml_mm - last_ml_mm_), last_ap_mm_ + part * (ap_mm - last_ap_mm_), events);
  }
  gap_ = 0;
}

void SwayWatch::settle(std::uint64_t now, double ml_mm, double ap_mm) noexcept {
  is_standing_ = true;
  since_ = now;
  for (posturography::CausalLowPass& pass : ml_filter_) pass.settle_at(ml_mm);
  for (posturography::CausalLowPass& pass : ap_filter_) pass.settle_at(ap_mm);
}

/// The gap is too long to be bridged: the person left the plate when it began.
void SwayWatch::lose(std::uint64_t now, Events& events) noexcept {
  const std::uint64_t missing = gap_;
  is_standing_ = false;
  since_ = gap_ = 0;
  if (window_ == Window::Free) close(events);
  if (window_ == Window::OfTrial) sums_.interrupt();
  for (std::uint64_t k = 1; k <= missing; ++k) follow_trial(now - missing + k, events);
}

void SwayWatch::measure(std::uint64_t now, double ml_mm, double ap_mm, Events& events) noexcept {
  for (posturography::CausalLowPass& pass : ml_filter_) ml_mm = pass.step(ml_mm);
  for (posturography::CausalLowPass& pass : ap_filter_) ap_mm = pass.step(ap_mm);
  if (now - since_ < lag_) return;  // describes a time before the person stood there
  const std::uint64_t described = now - lag_;
  follow_trial(described, events);
  if (window_ == Window::None && described - since_ >= settle_) open(Window::Free, described);
  if (window_ == Window::None || (described - first_) % divisor_ != 0) return;
  sums_.add(ml_mm, ap_mm);
  newest_ = described;
  has_news_ = true;
  if (described >= due_) report(events);
}

void SwayWatch::follow_trial(std::uint64_t described, Events& events) noexcept {
  if (window_ == Window::OfTrial && described >= trial_.end) close(events);
  if (window_ == Window::OfTrial || trial_.number == 0 || described < trial_.begin || described >= trial_.end) return;
  if (window_ == Window::Free) close(events);
  open(Window::OfTrial, described);
}

void SwayWatch::open(Window window, std::uint64_t described) noexcept {
  window_ = window;
  first_ = newest_ = described;
  due_ = described + every_;
  has_news_ = false;
  sums_.reset();
}

void SwayWatch::close(Events& events) noexcept {
  if (has_news_) report(events);
  open(Window::None, 0);
  due_ = 0;
}

void SwayWatch::report(Events& events) noexcept {
  core::SwayEvent event;
  event.scan = core::ScanIndex{newest_};
  event.first_scan = core::ScanIndex{first_};
  event.trial = window_ == Window::OfTrial ? trial_.number : 0;
  event.values = sums_.values();
  push_newest(events, event);
  has_news_ = false;
  due_ = first_ + ((newest_ - first_) / every_ + 1) * every_;
}

void SwayWatch::reset() noexcept {
  is_standing_ = false;
  since_ = gap_ = 0;
  last_ml_mm_ = last_ap_mm_ = 0.0;
  for (posturography::CausalLowPass& pass : ml_filter_) pass.set_state({});
  for (posturography::CausalLowPass& pass : ap_filter_) pass.set_state({});
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
  const bool has_its_trial = window_ != Window::OfTrial || trial_.number != 0;
  const bool is_window_possible = newest_ >= first_ && (window_ != Window::Free || is_standing_) && (gap_ == 0 || is_standing_);
  if (reader.is_right() && sums_.set_state(sums) && has_its_trial && is_window_possible) return true;
  reset();
  return false;
}

}  // namespace dts::pipeline
