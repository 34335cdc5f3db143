// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/sample_feed.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dts::emulator {
namespace {

__extension__ using Wide = __int128;

constexpr Wide kNanosecondsPerSecond = 1'000'000'000;
constexpr Wide kSpeedUnit = 1'000'000'000;

double seconds_of(core::Rate rate, std::uint64_t ticks) noexcept {
  return static_cast<double>(ticks) * static_cast<double>(rate.denominator()) / static_cast<double>(rate.numerator());
}

}  // namespace

void ScanClock::start(core::Rate rate, double speed, std::int64_t now_ns) noexcept {
  stop(now_ns);
  earlier_start_ = newest_start_;
  newest_start_ = before_;
  rate_ = rate;
  speed_e9_ = std::llround(speed * static_cast<double>(kSpeedUnit));
  start_ns_ = now_ns;
  is_running_ = true;
}

void ScanClock::stop(std::int64_t now_ns) noexcept {
  before_ = ticks(now_ns);
  is_running_ = false;
}

std::uint64_t ScanClock::ticks(std::int64_t now_ns) const noexcept {
  if (!is_running_ || now_ns <= start_ns_) return before_;
  const Wide elapsed = Wide{now_ns} - start_ns_;
  return before_ +
         static_cast<std::uint64_t>(elapsed * rate_.numerator() * speed_e9_ / (kNanosecondsPerSecond * kSpeedUnit * rate_.denominator()));
}

std::int64_t ScanClock::tick_ns(std::uint64_t number) const noexcept {
  if (number <= before_) return start_ns_;
  if (!is_running_) return kNeverNs;
  const Wide divisor = Wide{rate_.numerator()} * speed_e9_;
  const Wide periods = Wide{number - before_} * rate_.denominator() * kNanosecondsPerSecond * kSpeedUnit;
  const Wide time_ns = start_ns_ + (periods + divisor - 1) / divisor;
  return time_ns > Wide{kNeverNs} ? kNeverNs : static_cast<std::int64_t>(time_ns);
}

double ScanClock::device_time_s(std::uint64_t number) const noexcept {
  std::uint64_t start = number > newest_start_ ? newest_start_ : earlier_start_;
  if (!is_running_ && number > before_) start = before_;  // of the next start
  return seconds_of(rate_, number - start - 1);
}

void SampleFeed::begin(FeedSetup setup, Converter converter, Faults& faults) {
  setup_ = std::move(setup);
  converter_ = std::move(converter);
  faults_ = &faults;
  next_ = 0;
  evaluated_s_ = -1.0;
}

void SampleFeed::start(FeedSetup setup, Converter converter, Faults& faults, std::int64_t now_ns) {
  begin(std::move(setup), std::move(converter), faults);
  own_clock_.start(setup_.rate, (1.0 + faults.clock_error_ppm * 1e-6) * faults.rate_factor, now_ns);
  clock_ = &own_clock_;
  first_tick_ = own_clock_.ticks(now_ns);
}

void SampleFeed::start(FeedSetup setup, Converter converter, Faults& faults, const ScanClock& clock, std::int64_t now_ns) {
  begin(std::move(setup), std::move(converter), faults);
  clock_ = &clock;
  first_tick_ = clock.ticks(now_ns);
}

void SampleFeed::stop(std::int64_t now_ns) noexcept {
  if (clock_ != nullptr && taken(now_ns) > faults_->silence_at_code) faults_->silence_at_code = Faults::kNever;
  if (clock_ == &own_clock_) own_clock_.stop(now_ns);
  clock_ = nullptr;
}

std::uint64_t SampleFeed::taken(std::int64_t now_ns) const noexcept {
  const std::uint64_t codes = (clock_->ticks(now_ns) - first_tick_) * setup_.codes_per_tick;
  return setup_.last_code != 0 ? std::min(codes, setup_.last_code) : codes;
}

std::uint64_t SampleFeed::available(std::int64_t now_ns) const noexcept {
  if (clock_ == nullptr) return 0;
  const std::uint64_t codes = std::min(taken(now_ns), faults_->silence_at_code);
  if (codes <= next_) return 0;
  return codes - next_ - (drops_within(codes) ? 1 : 0);
}

bool SampleFeed::is_over_limit(std::int64_t now_ns) const noexcept {
  return setup_.fifo_codes != 0 && available(now_ns) > setup_.fifo_codes;
}

std::int64_t SampleFeed::ready_ns(std::uint64_t count) const noexcept {
  if (clock_ == nullptr) return kNeverNs;
  std::uint64_t end = next_ + count;
  if (drops_within(end)) ++end;
  if (end > faults_->silence_at_code) return kNeverNs;
  if (setup_.last_code != 0 && end > setup_.last_code) return kNeverNs;
  return clock_->tick_ns(first_tick_ + (end + setup_.codes_per_tick - 1) / setup_.codes_per_tick);
}

std::uint64_t SampleFeed::remaining(std::uint64_t count) const noexcept {
  return setup_.last_code == 0 ? count : std::min(count, setup_.last_code - std::min(next_, setup_.last_code));
}

double SampleFeed::next_tick_s(std::int64_t now_ns) const noexcept {
  if (clock_ == nullptr) return 0.0;
  return clock_->device_time_s(clock_->ticks(now_ns) + 1);
}

std::uint16_t SampleFeed::take() {
  if (next_ == faults_->drop_code_at) {
    faults_->drop_code_at = Faults::kNever;
    ++next_;
  }
  const std::uint64_t code_number = next_++;
  const std::uint64_t tick = code_number / setup_.codes_per_tick;
  const auto place = static_cast<double>(code_number % setup_.codes_per_tick);
  const double tick_s = clock_->device_time_s(first_tick_ + tick + 1);
  const double volts = look(tick_s + place * setup_.skew_s)[setup_.inputs[code_number % setup_.inputs.size()]];
  std::uint16_t code = converter_(code_number % setup_.inputs.size(), volts);
  if (code_number == faults_->corrupt_at_code) {
    faults_->corrupt_at_code = Faults::kNever;
    code = static_cast<std::uint16_t>(~code);
  }
  return code;
}

const std::vector<double>& SampleFeed::look(double time_s) {
  if (time_s != evaluated_s_) {
    source_(time_s, volts_);
    evaluated_s_ = time_s;
  }
  return volts_;
}

}  // namespace dts::emulator
