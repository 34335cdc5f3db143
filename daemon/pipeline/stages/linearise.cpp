// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/linearise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/fault.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"

namespace dts::pipeline {
namespace {

/// Converts volts to deflection from the nominal unloaded gap, before the baseline is subtracted.
void convert(const physics::SensorModel& sensor, const core::Block& in, core::Block& out, std::size_t channel) noexcept {
  const auto volts = in.column(channel);
  const auto bits_in = in.quality(channel);
  const auto deflection_mm = out.column(channel);
  const auto bits_out = out.quality(channel);
  for (std::size_t i = 0; i < volts.size(); ++i) {
    const core::Volts reading{volts[i]};
    const bool is_inside = sensor.curve.contains(reading);  // false for NaN
    deflection_mm[i] =
        std::isfinite(reading.value) ? (sensor.unloaded_gap - sensor.curve.gap(reading)).value : std::numeric_limits<double>::quiet_NaN();
    bits_out[i] = static_cast<std::uint8_t>(bits_in[i] | (is_inside ? 0 : core::quality::kOutOfRange));
  }
}

}  // namespace

Linearise::Linearise(const StageOptions& options, const StageContext& context)
    : rig_(&context.rig),
      tare_(&context.tare),
      tare_ms_(options.number("tare_ms")),
      tare_limit_mm_(options.number("tare_limit_mm")),
      tare_noise_mm_(options.number("tare_noise_mm")),
      tares_at_start_(options.word("tare_at_start") == "if_empty"),
      is_nominal_(options.word("baseline") == "nominal") {}

const StageDescription& Linearise::description() {
  static const StageDescription described{
      .id = "linearise",
      .sentence = "Turns volts into deflection by each sensor's curve and uses the empty plate as zero.",
      .output_stream = "deflection",
      .options = {
          {.name = "tare_ms", .sentence = "How long a tare averages.", .default_value = 1000.0, .minimum = 10.0, .maximum = 5'000.0},
          {.name = "tare_limit_mm",
           .sentence = "A sensor further than this from its nominal unloaded gap means that the plate is loaded.",
           .default_value = 0.5,
           .minimum = 0.001,
           .maximum = 10.0},
          {.name = "tare_noise_mm",
           .sentence = "A sensor that scatters more (rms) means that the plate moves.",
           .default_value = 0.1,  // noise of 3 mV at 0.35 V/mm is 0.009 mm
           .minimum = 0.001,
           .maximum = 10.0},
          {.name = "tare_at_start",
           .sentence = "if_empty: a segment that begins with an empty plate tares it, if there is no tare yet.",
           .choices = {"if_empty", "no"}},
          {.name = "baseline",
           .sentence = "Zero before the first tare: none, or the rig's unloaded gaps, which must be measured on this plate.",
           .choices = {"tare", "nominal"}}}};
  return described;
}

core::Result<core::StreamFormat> Linearise::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("linearise", input, max_scans, "V"));
  if (input.channels.size() != rig_->sensors.size()) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage linearise: " + std::to_string(input.channels.size()) +
                                                            " channels arrive, but the rig has " + std::to_string(rig_->sensors.size()) +
                                                            " sensors");
  }
  tare_scans_ = input.rate.scans_in_ms(tare_ms_);
  forget();
  core::StreamFormat output = input;
  for (std::size_t c = 0; c < output.channels.size(); ++c) output.channels[c] = {.name = rig_->sensors[c].label + "_mm", .unit = "mm"};
  return output;
}

void Linearise::process(const core::Block& in, core::Block& out) noexcept {
  handle_request();
  for (std::size_t c = 0; c < out.channel_count(); ++c) convert(rig_->sensors[c], in, out, c);
  // A tare ends at a scan and not at a block: the block is split where the baseline changes.
  const std::size_t averaged = static_cast<std::size_t>(std::min<std::uint64_t>(average_.remaining_scans(), out.count()));
  if (averaged > 0) {
    if (average_.remaining_scans() == tare_scans_) report(TareOutcome::Running);
    average_.add(out, 0, averaged);
    subtract_baseline(out, 0, averaged);
    if (average_.remaining_scans() == 0) finish_average();
  }
  subtract_baseline(out, averaged, out.count() - averaged);
}

void Linearise::handle_request() noexcept {
  const std::uint64_t requested = tare_->requested();
  if (requested == request_) return;
  request_ = requested;
  average_.start(tare_scans_);
}

void Linearise::finish_average() noexcept {
  const std::size_t sensors = rig_->sensors.size();
  if (tare_->is_cancelled(request_)) return report(TareOutcome::None);
  const TareOutcome outcome = average_.outcome(0, sensors, tare_limit_mm_, tare_noise_mm_);
  if (outcome == TareOutcome::Done) {
    for (std::size_t c = 0; c < sensors; ++c) baseline_mm_[c] = average_.mean(c);
    is_tared_ = true;
  }
  report(outcome);
}

void Linearise::subtract_baseline(core::Block& out, std::size_t first, std::size_t scans) const noexcept {
  const std::uint8_t doubt = is_tared_ ? 0 : core::quality::kUntared;
  for (std::size_t c = 0; c < out.channel_count(); ++c) {
    const double baseline_mm = baseline_mm_[c];
    for (double& deflection_mm : out.column(c).subspan(first, scans)) deflection_mm -= baseline_mm;
    for (std::uint8_t& bits : out.quality(c).subspan(first, scans)) bits |= doubt;
  }
}

void Linearise::report(TareOutcome outcome) noexcept {
  tare_->report({.request = request_,
                 .outcome = outcome,
                 .is_older_in_use = is_tared_ && outcome != TareOutcome::Running && outcome != TareOutcome::Done,
                 .channel_count = rig_->sensors.size(),
                 .unit = ZeroUnit::Millimetres,
                 .baseline = baseline_mm_});
}

std::size_t Linearise::state_size() const noexcept {
  const std::size_t sensors = rig_->sensors.size();
  return 1 + sensors + BaselineAverage::state_size(sensors);
}

void Linearise::save(std::span<double> state) const noexcept {
  const std::size_t sensors = rig_->sensors.size();
  StateWriter writer(state);
  writer.put(is_tared_ ? 1.0 : 0.0);
  for (std::size_t c = 0; c < sensors; ++c) writer.put(baseline_mm_[c]);
  average_.save(writer, sensors);
}

bool Linearise::restore(std::span<const double> state) noexcept {
  const std::size_t sensors = rig_->sensors.size();
  StateReader reader(state, state_size());
  is_tared_ = reader.flag() || is_nominal_;
  const double largest_mm = is_tared_ ? tare_limit_mm_ : 0.0;  // a larger offset is rejected by a tare
  for (std::size_t c = 0; c < sensors; ++c) baseline_mm_[c] = reader.number(-largest_mm, largest_mm);
  average_.restore(reader, sensors, tare_scans_);
  if (!reader.is_right()) {
    forget();
    return false;
  }
  if (is_tared_) report(TareOutcome::Done);
  return true;
}

void Linearise::forget() noexcept {
  baseline_mm_ = {};
  is_tared_ = is_nominal_;
  average_.stop();
  reset();
}

void Linearise::reset() noexcept {
  const bool is_interrupted = average_.remaining_scans() > 0;
  if (is_interrupted || (tares_at_start_ && !is_tared_)) average_.start(tare_scans_);
}

}  // namespace dts::pipeline
