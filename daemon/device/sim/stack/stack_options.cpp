// SPDX-License-Identifier: Apache-2.0
#include "device/sim/stack/stack_options.h"

#include <array>
#include <string>

#include "device/sim/shared_options.h"

namespace dts::device::sim {
namespace {

using core::ErrorCode;
using enum OptionKind;

constexpr double kSecondsPerMinute = 60.0;

constexpr std::array kStackTable = {
    UriOption{"part", Word, "floor", 0, 0, "floor|plate", "Which part this device is: the floor platform, or the force plate below it."},
    UriOption{"seed", Integer, "1", 0, 4294967295.0, "", "Chooses the person and all else that is random; both parts need the same."},
    UriOption{"contact", Word, "feet", 0, 0, "feet|one_foot", "A person on two feet or on one."},
    UriOption{"weight_n", Number, "686", 50, 2000, "", "Body weight."},
    UriOption{"x_mm", Number, "0", -1000, 1000, "", "ML position of the stance, from the centre of both plates."},
    UriOption{"y_mm", Number, "0", -1000, 1000, "", "AP position of the stance."},
    UriOption{"stance_width_mm", Number, "200", 50, 600, "", "Distance between the middle lines of the feet (contact=feet)."},
    UriOption{"step_on_s", Number, "5", 0, 86400, "", "True time at which the person first touches the platform."},
    UriOption{"step_off_s", Number, "never", 0, kNever, "", "True time at which the person begins to leave."},
    UriOption{"height_mm", Number, "50", 0, 500, "", "Top of the floor platform above the force plate (part=plate)."},
    UriOption{"offset_s", Number, "0", -3600, 3600, "", "Everything appears this much later in the device's data than it happens."},
    shared_option::kClock,
    UriOption{"cross_talk", Number, "0.01", 0, 0.1, "",
              "Largest part of vertical force that shows as shear, and the reverse (part=plate)."},
    UriOption{"drift_n_per_min", Number, "0.6", 0, 100, "", "Creep of the zero of the vertical force (part=plate)."},
    UriOption{"plate", Word, "nonlinear", 0, 0, "nonlinear|linear",
              "A platform that stiffens under body weight, or Kirchhoff's (part=floor)."},
    shared_option::kGainSpread,
    UriOption{"gap_spread_mm", Number, "0.02", 0, 1, "", "Unloaded gaps differ from the nominal one by up to this (part=floor)."},
    UriOption{"noise_mv", Number, "0.5", 0, 1000, "", "White noise of every input, rms."},
    UriOption{"bits", Integer, "16", 11, 16, "", "Resolution of the converter."},
    UriOption{"range_v", Number, "10", 6, 10, "", "Range of the converter, to both sides of 0 V; the sync signal has 5 V."},
    UriOption{"truth", Integer, "1", 0, 1, "", "1: auxiliary channels with the true centre of pressure and force."},
    shared_option::kFault,
    shared_option::kFaultAt,
    shared_option::kFaultFor,
    shared_option::kFaultChannel,
};

constexpr std::array kStackDependencies = {
    Dependency{"stance_width_mm", "contact", "feet"}, Dependency{"height_mm", "part", "plate"}, Dependency{"cross_talk", "part", "plate"},
    Dependency{"drift_n_per_min", "part", "plate"},   Dependency{"plate", "part", "floor"},     Dependency{"gain_spread", "part", "floor"},
    Dependency{"gap_spread_mm", "part", "floor"},     shared_option::kFaultChannelNeeds,
};

physics::Stance stack_stance(const UriOptions& options, std::uint64_t seed) {
  physics::Stance result;
  result.kind = options.text("contact") == "one_foot" ? physics::ContactKind::OneFoot : physics::ContactKind::Feet;
  result.load = core::Newtons{options.number("weight_n")};
  result.centre_ml = core::Millimetres{options.number("x_mm")};
  result.centre_ap = core::Millimetres{options.number("y_mm")};
  result.width = core::Millimetres{options.number("stance_width_mm")};
  result.step_on_s = options.number("step_on_s");
  result.step_off_s = options.number("step_off_s");
  result.seed = seed;
  return result;
}

/// Fails if the rig cannot be this part.
core::Result<std::size_t> inputs_of(const DeviceUri& uri, StackPart part, const physics::RigModel& rig) {
  if (part == StackPart::Plate) {
    if (rig.force_plate) return rig.force_plate->plate.channel_count();
    return refuse(uri, ErrorCode::InvalidArgument, "part=plate needs a rig with [force_plate]; this rig has none");
  }
  if (!rig.sensors.empty()) return rig.sensors.size();
  return refuse(uri, ErrorCode::InvalidArgument, "part=floor needs a rig with sensors under a plate; for a force plate write part=plate");
}

}  // namespace

std::span<const UriOption> stack_option_table() { return kStackTable; }

core::Result<StackOptions> read_stack_options(const DeviceUri& uri, const physics::RigModel& rig) {
  DTS_TRY_ASSIGN(const auto options, UriOptions::read(uri, kStackTable));
  DTS_TRY(check_dependencies(uri, options, kStackDependencies));

  StackOptions result;
  result.part = options.text("part") == "plate" ? StackPart::Plate : StackPart::Floor;
  DTS_TRY_ASSIGN(result.inputs, inputs_of(uri, result.part, rig));
  result.seed = static_cast<std::uint64_t>(options.number("seed"));
  result.stance = stack_stance(options, result.seed);
  result.height_mm = options.number("height_mm");
  result.defects = {options.number("cross_talk"), options.number("drift_n_per_min") / kSecondsPerMinute, result.seed};
  result.mounting.seed = result.seed;
  result.mounting.sensors = result.inputs;
  result.mounting.has_truth = false;
  result.mounting.is_plate_stiffening = options.text("plate") == "nonlinear";
  result.mounting.gain_spread = options.number("gain_spread");
  result.mounting.gap_spread_mm = options.number("gap_spread_mm");
  result.offset_s = options.number("offset_s");
  result.clock_error_ppm = options.number("clock_ppm");
  // The parts have different converters, so their noise must differ.
  const std::uint64_t noise_seed = result.part == StackPart::Plate ? ~result.seed : result.seed;
  result.daq = {options.number("range_v"), static_cast<int>(options.number("bits")), options.number("noise_mv") * kMillivolt, noise_seed};
  result.has_truth = options.number("truth") == 1.0;
  DTS_TRY_ASSIGN(result.fault, read_fault(uri, options, result.converted_channels()));
  return result;
}

}  // namespace dts::device::sim
