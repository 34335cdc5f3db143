// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/force_plate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/special_numbers.h"
#include "pipeline/fault.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"
#include "pipeline/stages/force_stream.h"

namespace dts::pipeline {
namespace {

constexpr double kLargestVolts = 1e6;  // limit for values from a file

}  // namespace

ForcePlate::ForcePlate(const StageOptions& options, const StageContext& context)
    : plate_(context.rig.force_plate ? &*context.rig.force_plate : nullptr),
      tare_(&context.tare),
      tare_ms_(options.number("tare_ms")),
      tare_limit_n_(options.number("tare_limit_n")),
      tare_noise_n_(options.number("tare_noise_n")),
      tares_at_start_(options.word("tare_at_start") == "if_empty"),
      drift_ms_(options.number("drift_ms")) {}

const StageDescription& ForcePlate::description() {
  static const StageDescription described{
      .id = "force_plate",
      .sentence = "Turns the volts of a force plate into force and moment and uses the empty plate as zero.",
      .output_stream = "force",
      .options = {
          {.name = "tare_ms", .sentence = "How long a tare averages.", .default_value = 1000.0, .minimum = 10.0, .maximum = 5'000.0},
          {.name = "tare_limit_n",
           .sentence = "A vertical force further than this from the zero of the rig file means that the plate is loaded.",
           .default_value = 100.0,
           .minimum = 1.0,
           .maximum = 20'000.0},
          {.name = "tare_noise_n",
           .sentence = "A vertical force that scatters more (rms) means that the plate moves.",
           .default_value = 5.0,
           .minimum = 0.01,
           .maximum = 1'000.0},
          {.name = "tare_at_start",
           .sentence = "if_empty: a segment that begins with an empty plate tares it, if there is no tare yet.",
           .choices = {"if_empty", "no"}},
          {.name = "drift_ms",
           .sentence = "How long the plate must be empty for each measurement of the drift.",
           .default_value = 20'000.0,
           .minimum = 1'000.0,
           .maximum = 600'000.0}}};
  return described;
}

core::Result<core::StreamFormat> ForcePlate::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("force_plate", input, max_scans, "V"));
  if (plate_ == nullptr) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage force_plate: the rig is not a force plate",
                      "describe the plate in the rig file: [force_plate]");
  }
  if (input.channels.size() != channel_count()) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage force_plate: " + std::to_string(input.channels.size()) +
                                                            " channels arrive, but the force plate has " + std::to_string(channel_count()));
  }
  std::ranges::copy(plate_->tare_v, file_zero_v_.begin());
  tare_scans_ = input.rate.scans_in_ms(tare_ms_);
  averaged_ = core::Block(channel_count() + 1, max_scans);
  drift_.prepare(input.rate, drift_ms_);
  forget();
  core::StreamFormat output = input;
  output.channels = force_channels(plate_->plate.measures_shear());
  return output;
}

void ForcePlate::process(const core::Block& in, core::Block& out) noexcept {
  handle_request();
  // A tare ends at a scan and not at a block: the block is split where the zero changes.
  const std::size_t averaged = static_cast<std::size_t>(std::min<std::uint64_t>(average_.remaining_scans(), in.count()));
  if (averaged > 0) {
    if (average_.remaining_scans() == tare_scans_) report(TareOutcome::Running);
    average(in, averaged);
    compute(in, out, 0, averaged);
    if (average_.remaining_scans() == 0) finish_average();
  }
  compute(in, out, averaged, in.count() - averaged);
}

void ForcePlate::handle_request() noexcept {
  const std::uint64_t requested = tare_->requested();
  if (requested == request_) return;
  request_ = requested;
  average_.start(tare_scans_);
}

physics::Wrench ForcePlate::wrench(const Volts& volts, const Volts& zero_v) const noexcept {
  Volts above{};
  for (std::size_t c = 0; c < channel_count(); ++c) above[c] = volts[c] - zero_v[c];
  return physics::in_subject_frame(plate_->plate.wrench(std::span(above).first(channel_count())), plate_->mounting);
}

void ForcePlate::average(const core::Block& in, std::size_t scans) noexcept {
  averaged_.set_count(scans);
  const std::size_t vertical = channel_count();
  for (std::size_t i = 0; i < scans; ++i) {
    Volts volts{};
    std::uint8_t bits = 0;
    for (std::size_t c = 0; c < channel_count(); ++c) {
      volts[c] = in.column(c)[i];
      averaged_.column(c)[i] = volts[c];
      averaged_.quality(c)[i] = explained(volts[c], in.quality(c)[i]);
      bits |= averaged_.quality(c)[i];
    }
    averaged_.column(vertical)[i] = wrench(volts, file_zero_v_).force_n[2];
    averaged_.quality(vertical)[i] = bits;
  }
  average_.add(averaged_, 0, scans);
}

void ForcePlate::finish_average() noexcept {
  if (tare_->is_cancelled(request_)) return report(TareOutcome::None);
  const TareOutcome outcome =
      has_possible_means() ? average_.outcome(channel_count(), channel_count() + 1, tare_limit_n_, tare_noise_n_) : TareOutcome::BadSensor;
  if (outcome == TareOutcome::Done) {
    for (std::size_t c = 0; c < channel_count(); ++c) zero_v_[c] = average_.mean(c);
    is_tared_ = true;
    drift_.set_zero(tare_scans_);
  }
  report(outcome);
}

/// Returns false for sums of a damaged state, which would make every later value infinite.
bool ForcePlate::has_possible_means() const noexcept {
  for (std::size_t c = 0; c < channel_count(); ++c) {
    if (!(std::abs(average_.mean(c)) <= kLargestVolts)) return false;
  }
  return true;
}

void ForcePlate::compute(const core::Block& in, core::Block& out, std::size_t first, std::size_t scans) noexcept {
  const ForceStream stream(out);
  for (std::size_t i = first; i < first + scans; ++i) {
    Volts volts{};
    std::uint8_t bits = is_tared_ ? 0 : core::quality::kUntared;
    for (std::size_t c = 0; c < channel_count(); ++c) {
      volts[c] = in.column(c)[i];
      bits |= explained(volts[c], in.quality(c)[i]);
    }
    if ((bits & kFaultBits) != 0) {
      drift_.skip();
      stream.put({.force_n = {core::kNaN, core::kNaN, core::kNaN}, .moment_nm = {core::kNaN, core::kNaN, core::kNaN}}, bits, out, i);
      continue;
    }
    const physics::Wrench reaction = wrench(volts, zero_v_);
    if (drift_.add(reaction.force_n[2])) report(outcome_);
    if (drift_.is_doubtful(reaction.force_n[2])) bits |= core::quality::kUntared;
    stream.put(reaction, bits, out, i);
  }
}

void ForcePlate::report(TareOutcome outcome) noexcept {
  outcome_ = outcome;
  tare_->report({.request = request_,
                 .outcome = outcome,
                 .is_older_in_use = is_tared_ && outcome != TareOutcome::Running && outcome != TareOutcome::Done,
                 .channel_count = channel_count(),
                 .unit = ZeroUnit::Volts,
                 .baseline = zero_v_,
                 .drift_n_per_min = drift_.n_per_min()});
}

std::size_t ForcePlate::state_size() const noexcept {
  return 1 + channel_count() + BaselineAverage::state_size(channel_count() + 1) + ZeroDrift::kStateSize;
}

void ForcePlate::save(std::span<double> state) const noexcept {
  StateWriter writer(state);
  writer.put(is_tared_ ? 1.0 : 0.0);
  for (std::size_t c = 0; c < channel_count(); ++c) writer.put(zero_v_[c]);
  average_.save(writer, channel_count() + 1);
  drift_.save(writer);
}

bool ForcePlate::restore(std::span<const double> state) noexcept {
  StateReader reader(state, state_size());
  is_tared_ = reader.flag();
  for (std::size_t c = 0; c < channel_count(); ++c) zero_v_[c] = reader.number(-kLargestVolts, kLargestVolts);
  average_.restore(reader, channel_count() + 1, tare_scans_);
  drift_.restore(reader);
  if (!reader.is_right()) {
    forget();
    return false;
  }
  if (is_tared_) report(TareOutcome::Done);
  return true;
}

void ForcePlate::forget() noexcept {
  zero_v_ = file_zero_v_;
  is_tared_ = false;
  average_.stop();
  reset();
}

void ForcePlate::reset() noexcept {
  // What is known of a zero outlasts a gap, as the zero itself does.
  is_tared_ ? drift_.resume() : drift_.reset();
  const bool is_interrupted = average_.remaining_scans() > 0;
  if (is_interrupted || (tares_at_start_ && !is_tared_)) average_.start(tare_scans_);
}

}  // namespace dts::pipeline
