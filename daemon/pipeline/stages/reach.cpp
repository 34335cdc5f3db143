// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/reach.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {
namespace {

constexpr double kSlowestHz = 75.0;  // below this rate, the dip of the reach initiation stage has only a few samples

}  // namespace

Reach::Reach(const StageOptions& options, const StageContext& /*context*/)
    : limits_{.least_rest_ratio = options.number("least_rest_ratio"),
              .most_rest_ratio = options.number("most_rest_ratio"),
              .most_twist = options.number("most_twist")} {}

const StageDescription& Reach::description() {
  static const StageDescription described{.id = "reach",
                                          .sentence = "Finds reaches in the transient of a chair and measures them: P1, P2, P3.",
                                          .output_stream = "",
                                          .options = {{.name = "least_rest_ratio",
                                                       .sentence = "Lowest plausible front to rear ratio of a person at rest.",
                                                       .default_value = SeatLimits{}.least_rest_ratio,
                                                       .minimum = -2.0,
                                                       .maximum = 2.0},
                                                      {.name = "most_rest_ratio",
                                                       .sentence = "Highest plausible front to rear ratio of a person at rest.",
                                                       .default_value = SeatLimits{}.most_rest_ratio,
                                                       .minimum = -2.0,
                                                       .maximum = 2.0},
                                                      {.name = "most_twist",
                                                       .sentence = "Largest plausible twist of a person at rest, either way.",
                                                       .default_value = SeatLimits{}.most_twist,
                                                       .minimum = 0.0,
                                                       .maximum = 4.0}}};
  return described;
}

core::Result<core::StreamFormat> Reach::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("reach", input, max_scans, ""));
  const bool is_transient = input.channels.size() == 3 && input.channels[0].unit == "mm" && input.channels[1].unit == "1";
  if (!is_transient) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage reach: the input is not a transient (mm, ratio, twist)",
                      "put stage 'transient' before it");
  }
  if (input.rate.hz() < kSlowestHz) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage reach: " + std::to_string(input.rate.hz()) + " Hz are too slow; it needs " +
                                                            std::to_string(static_cast<int>(kSlowestHz)) + " Hz");
  }
  rate_ = input.rate;
  input_delay_scans_ = static_cast<std::uint64_t>(std::max(0.0, std::round(static_cast<double>(input.delay_ns) * 1e-9 * rate_.hz())));
  smoother_.prepare(rate_);
  machine_.prepare(rate_.hz() / static_cast<double>(smoother_.divisor()), limits_);
  reset();
  return input;
}

void Reach::process(const core::Block& in, core::Block& /*out*/) noexcept {
  events_.clear();
  const auto mm = in.column(0);
  const auto ratio = in.column(1);
  const auto twist = in.column(2);
  const auto bits = in.quality(0);
  for (std::size_t i = 0; i < in.count(); ++i) {
    if (!smoother_.add(mm[i], ratio[i], twist[i], bits[i])) continue;
    const std::size_t before = events_.count;
    machine_.step(smoother_.sample(), events_);
    for (std::size_t k = before; k < events_.count; ++k) translate(events_.events[k], in, i);
  }
}

/// Converts sample numbers to scans.
void Reach::translate(core::ReachEvent& event, const core::Block& in, std::size_t scan) const noexcept {
  const std::uint64_t completing = in.first_scan.value + scan;
  const std::uint64_t now = event.scan.value;
  const auto scan_of = [&](core::ScanIndex tick) {
    const std::uint64_t ago = (now - std::min(now, tick.value)) * smoother_.divisor() + smoother_.delay_scans() + input_delay_scans_;
    return core::ScanIndex{completing - std::min(completing, ago)};
  };
  event.p1.scan = scan_of(event.p1.scan);
  if (std::isfinite(event.p2.value_mm)) event.p2.scan = scan_of(event.p2.scan);
  if (std::isfinite(event.p3.value_mm)) event.p3.scan = scan_of(event.p3.scan);
  event.scan = core::ScanIndex{completing};
  event.segment = in.segment;
  event.host_time_ns = in.host_time_ns + (rate_.time_ns(event.scan) - rate_.time_ns(in.first_scan));
}

void Reach::tell(core::FrameEvents& events) noexcept {
  for (const core::ReachEvent& event : events_.all_of()) events.reaches.push(event);
  events.reaches.lost += events_.lost;
  events_.clear();
}

void Reach::reset() noexcept {
  smoother_.reset();
  machine_.reset();
  events_.clear();
}

std::size_t Reach::state_size() const noexcept { return Smoother::kStateSize + ReachMachine::kStateSize; }

void Reach::save(std::span<double> state) const noexcept {
  StateWriter writer(state);
  smoother_.save(writer);
  machine_.save(writer);
}

bool Reach::restore(std::span<const double> state) noexcept {
  StateReader reader(state, state_size());
  smoother_.restore(reader);
  machine_.restore(reader);
  events_.clear();
  if (!reader.is_right()) reset();
  return reader.is_right();
}

}  // namespace dts::pipeline
