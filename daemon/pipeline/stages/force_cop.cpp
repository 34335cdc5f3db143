// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/force_cop.h"

#include <cmath>
#include <string>

#include "core/special_numbers.h"
#include "pipeline/fault.h"
#include "pipeline/input_check.h"
#include "pipeline/stage_state.h"
#include "pipeline/stages/force_stream.h"

namespace dts::pipeline {

using core::kNaN;

ForceCop::ForceCop(const StageOptions& options, const StageContext& context)
    : rig_(&context.rig), contact_(options.number("contact_threshold_n")), top_mm_(options.number("top_mm")) {
  if (const auto& plate = rig_->force_plate; plate && plate->polynomial) {
    polynomial_ = physics::in_subject_frame(*plate->polynomial, plate->mounting);
  }
}

const StageDescription& ForceCop::description() {
  static const StageDescription described{
      .id = "force_cop",
      .sentence = "Computes centre of pressure and load from the force and moment of a force plate.",
      .output_stream = "cop",
      .options = {{.name = "contact_threshold_n",
                   .sentence = "Load from which a person counts as standing on the plate, until it falls below 80 % of this load.",
                   .default_value = 20.0,
                   .minimum = 1.0,
                   .maximum = 2000.0},
                  {.name = "top_mm",
                   .sentence = "Height of what is on the force plate, for example a DTS platform: the centre of pressure is on its top.",
                   .default_value = 0.0,
                   .minimum = 0.0,
                   .maximum = 1000.0}}};
  return described;
}

core::Result<core::StreamFormat> ForceCop::prepare(const core::StreamFormat& input, std::size_t max_scans) {
  DTS_TRY(check_input("force_cop", input, max_scans, ""));
  const auto refuse = [](const std::string& what, const std::string& hint) {
    return core::fail(core::ErrorCode::InvalidArgument, "stage force_cop: " + what, hint);
  };
  const bool has_shear = input.channels == force_channels(true);
  if (!has_shear && input.channels != force_channels(false)) {
    return refuse("its input is not force and moment of a force plate", "put stage force_plate before it");
  }
  if (!has_shear && top_mm_ > 0.0) return refuse("option 'top_mm' needs shear, which load cells do not measure", "set top_mm = 0");
  reset();
  core::StreamFormat output = input;
  output.channels = {{.name = "ml_mm", .unit = "mm"}, {.name = "ap_mm", .unit = "mm"}, {.name = "load_n", .unit = "N"}};
  return output;
}

void ForceCop::process(const core::Block& in, core::Block& out) noexcept {
  const ForceStream stream(in);
  const auto put = [&out](std::size_t scan, double ml_mm, double ap_mm, std::uint8_t bits, double load_n, std::uint8_t load_bits) {
    out.column(0)[scan] = ml_mm;
    out.column(1)[scan] = ap_mm;
    out.column(2)[scan] = load_n;
    out.quality(0)[scan] = bits;
    out.quality(1)[scan] = bits;
    out.quality(2)[scan] = load_bits;
  };
  for (std::size_t i = 0; i < in.count(); ++i) {
    std::uint8_t bits = 0;
    for (std::size_t c = 0; c < in.channel_count(); ++c) bits |= explained(in.column(c)[i], in.quality(c)[i]);
    if ((bits & kFaultBits) != 0) {  // does not show whether there is contact: the state stays
      put(i, kNaN, kNaN, bits, kNaN, bits);
      continue;
    }
    const physics::Wrench wrench = stream.get(in, i);
    const double load_n = wrench.force_n[2];
    if (!contact_.update(load_n)) {
      put(i, kNaN, kNaN, static_cast<std::uint8_t>(bits | core::quality::kNoContact), load_n, bits);
      continue;
    }
    const physics::ForcePoint point = polynomial_ ? physics::corrected(wrench, *polynomial_) : physics::force_point(wrench);
    const double ml_mm = point.x_mm + top_mm_ * wrench.force_n[0] / load_n;
    const double ap_mm = point.y_mm + top_mm_ * wrench.force_n[1] / load_n;
    const bool is_inside = std::abs(ml_mm) <= 0.5 * rig_->plate.a.value && std::abs(ap_mm) <= 0.5 * rig_->plate.b.value;
    if (!is_inside) bits |= core::quality::kUncalibrated;
    put(i, ml_mm, ap_mm, bits, load_n, bits);
  }
}

void ForceCop::save(std::span<double> state) const noexcept {
  StateWriter writer(state);
  contact_.save(writer);
}

bool ForceCop::restore(std::span<const double> state) noexcept {
  StateReader reader(state, state_size());
  contact_.restore(reader);
  if (!reader.is_right()) reset();
  return reader.is_right();
}

}  // namespace dts::pipeline
