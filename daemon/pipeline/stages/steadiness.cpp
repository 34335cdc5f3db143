// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/steadiness.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/special_numbers.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {
namespace {

using core::kNaN;
constexpr double kSlowestSwayHz = 20.0;                          // a low-pass of 10 Hz needs more than this
constexpr std::uint64_t kLargestScan = std::uint64_t{1} << 53U;  // the largest that a state can hold

/// Returns whether the windows are equal, apart from their number.
bool is_same_window(const SteadinessWindow& a, const SteadinessWindow& b) noexcept {
  return a.trial == b.trial && a.segment == b.segment && a.first_scan == b.first_scan && a.end_scan == b.end_scan;
}

}  // namespace

Steadiness::Steadiness(const StageOptions& options, const StageContext& context)
    : windows_(&context.windows),
      given_rate_(context.raw_rate),
      every_ms_(options.number("every_ms")),
      settle_ms_(options.number("settle_ms")) {}

const StageDescription& Steadiness::description() {
  static const StageDescription described{
      .id = "steadiness",
      .sentence = "Publishes running measures of quiet standing, from the centre of pressure.",
      .output_stream = "",
      .options = {{.name = "every_ms",
                   .sentence = "Time between two publications of the running measures.",
                   .default_value = 500.0,
                   .minimum = 100.0,
                   .maximum = 10'000.0},
                  {.name = "settle_ms",
                   .sentence = "Without a trial: how long a person must stand still before the measurement begins.",
                   .default_value = 1000.0,
                   .minimum = 0.0,
                   .maximum = 60'000.0}}};
  return described;
}

core::Result<core::StreamFormat> Steadiness::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("steadiness", input, max_scans, ""));
  const bool is_cop =
      input.channels.size() == 3 && input.channels[0].unit == "mm" && input.channels[1].unit == "mm" && input.channels[2].unit == "N";
  if (!is_cop) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage steadiness: the input is not a centre of pressure (mm, mm, N)",
                      "put stage 'cop' before it");
  }
  if (input.rate.hz() <= kSlowestSwayHz) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage steadiness: " + std::to_string(input.rate.hz()) +
                                                            " Hz are too slow; its low-pass of 10 Hz needs more than 20 Hz");
  }
  raw_rate_ = given_rate_.value_or(input.rate);
  raw_per_scan_ = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::round(raw_rate_.hz() / input.rate.hz())));
  delay_scans_ = static_cast<std::uint64_t>(std::max(0.0, std::round(static_cast<double>(input.delay_ns) * 1e-9 * raw_rate_.hz())));
  watch_.prepare(input.rate, every_ms_, settle_ms_);
  forget();
  return input;
}

void Steadiness::process(const core::Block& in, core::Block& /*out*/) noexcept {
  events_.clear();
  update_window(in.segment);
  const auto ml_mm = in.column(0);
  const auto ap_mm = in.column(1);
  const auto load_n = in.column(2);
  for (std::size_t i = 0; i < in.count(); ++i) {
    const bool is_empty = load_n[i] <= 0.0;  // a COP without load is meaningless; with an unknown load (NaN) it may be valid
    watch_.process(in.first_scan.value + i, {.ml_mm = is_empty ? kNaN : ml_mm[i], .ap_mm = ap_mm[i], .load_n = load_n[i]}, events_);
  }
  for (core::SwayEvent& event : std::span(events_.events).first(events_.count)) translate(event, in);
}

void Steadiness::update_window(std::uint32_t segment) noexcept {
  const SteadinessWindow& latest = windows_->latest();
  const bool is_new = latest.number != letter_ && !is_same_window(latest, window_);
  if (latest.number != letter_ && latest.is_restart) watch_.restart(events_);
  letter_ = latest.number;
  if (!is_new && segment == segment_) return;
  if (is_new) window_ = latest;
  segment_ = segment;
  watch_.expect(trial_in(segment), events_);
}

SwayWatch::Trial Steadiness::trial_in(std::uint32_t segment) const noexcept {
  if (window_.trial == 0 || window_.segment != segment) return {};
  return {.number = window_.trial, .begin = index_of(window_.first_scan), .end = index_of(window_.end_scan)};
}

/// Returns the first index of the input that describes `scan` or a later one.
std::uint64_t Steadiness::index_of(core::ScanIndex scan) const noexcept {
  return (std::min(scan.value, kLargestScan) + delay_scans_ + raw_per_scan_ - 1) / raw_per_scan_;
}

core::ScanIndex Steadiness::scan_of(std::uint64_t index) const noexcept {
  const std::uint64_t completing = index * raw_per_scan_;
  return {completing - std::min(completing, delay_scans_)};
}

/// Converts indices to scans.
void Steadiness::translate(core::SwayEvent& event, const core::Block& in) const noexcept {
  event.segment = in.segment;
  // Not after this block, even with a wrong restored state: times must stay valid.
  event.scan = scan_of(std::min(event.scan.value, in.first_scan.value + in.count() - 1));
  event.first_scan = std::min(scan_of(event.first_scan.value), event.scan);
  const core::ScanIndex completing{in.first_scan.value * raw_per_scan_};
  event.host_time_ns = in.host_time_ns + (raw_rate_.time_ns(event.scan) - raw_rate_.time_ns(completing));
}

void Steadiness::tell(core::FrameEvents& events) noexcept {
  for (const core::SwayEvent& event : events_.all_of()) events.sways.push(event);
  events.sways.lost += events_.lost;
  events_.clear();
}

void Steadiness::reset() noexcept {
  watch_.reset();
  events_.clear();
}

/// Returns to the initial state, so that the current window will be read again.
void Steadiness::forget() noexcept {
  letter_ = 0;
  window_ = {};
  segment_ = 0;
  SwayWatch::Events none;
  watch_.expect({}, none);
}

std::size_t Steadiness::state_size() const noexcept { return 5 + watch_.state_size(); }

void Steadiness::save(std::span<double> state) const noexcept {
  StateWriter writer(state);
  writer.put_count(segment_);
  writer.put_count(window_.trial);
  writer.put_count(window_.segment);
  writer.put_count(std::min(window_.first_scan.value, kLargestScan));
  writer.put_count(std::min(window_.end_scan.value, kLargestScan));
  watch_.save(writer);
}

bool Steadiness::restore(std::span<const double> state) noexcept {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint32_t>::max();
  forget();
  StateReader reader(state, state_size());
  segment_ = static_cast<std::uint32_t>(reader.count(kLargest));
  window_.trial = static_cast<std::uint32_t>(reader.count(kLargest));
  window_.segment = static_cast<std::uint32_t>(reader.count(kLargest));
  window_.first_scan = core::ScanIndex{reader.count(kLargestScan)};
  window_.end_scan = core::ScanIndex{reader.count(kLargestScan)};
  if (watch_.restore(reader, trial_in(segment_))) return true;
  forget();
  return false;
}

}  // namespace dts::pipeline
