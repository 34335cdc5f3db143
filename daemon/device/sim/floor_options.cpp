// SPDX-License-Identifier: Apache-2.0
#include "device/sim/floor_options.h"

#include <array>

#include "core/block.h"
#include "device/sim/shared_options.h"

namespace dts::device::sim {
namespace {

using core::ErrorCode;
using enum OptionKind;

constexpr std::array kFloorTable = {
    UriOption{"seed", Integer, "1", 0, 4294967295.0, "", "Chooses sway, noise, gains and gaps; the same seed gives the same data."},
    UriOption{
        "contact", Word, "feet", 0, 0, "feet|one_foot|point|weights|gaps",
        "A person on two feet or on one, a weight at one point, weights of a list one after the other, or spacers before the sensors."},
    UriOption{"weight_n", Number, "686", 50, 2000, "", "Body weight (contact=feet|one_foot)."},
    UriOption{"load_n", Number, "490", 1, 2000, "", "Load of the weight (contact=point)."},
    UriOption{"x_mm", Number, "0", -1000, 1000, "", "ML position of the weight or of the stance, from the plate's centre."},
    UriOption{"y_mm", Number, "0", -1000, 1000, "", "AP position of the weight or of the stance, from the plate's centre."},
    UriOption{"stance_width_mm", Number, "200", 50, 600, "", "Distance between the middle lines of the feet."},
    UriOption{"step_on_s", Number, "2.5", 0, 86400, "",
              "When the person first touches the plate; it is empty before, so that it can be tared."},
    UriOption{"step_off_s", Number, "never", 0, kNever, "", "When the person or weight begins to leave (contact=feet|one_foot|point)."},
    UriOption{"cop", File, "", 0, 0, "", "Recorded COP to repeat (CSV t_s,x_mm,y_mm) instead of synthetic sway."},
    UriOption{"weights", File, "", 0, 0, "", "Weights to put down in turn (CSV x_mm,y_mm,load_n; contact=weights)."},
    UriOption{"gaps_mm", Numbers, "", 0.1, 1000, "", "Gaps that every sensor sees in turn (contact=gaps)."},
    UriOption{"hold_s", Number, "3", 0, 86400, "", "How long each weight or spacer stays."},
    UriOption{"pause_s", Number, "1", 0, 86400, "", "How long the plate is empty between two of them."},
    UriOption{"ramp_s", Number, "0.5", 0, 60, "", "How long it takes to put one down, and to remove it."},
    UriOption{"loop", Integer, "0", 0, 1, "", "1: repeat the recording, weights or gaps forever; 0: leave at the end."},
    UriOption{"plate", Word, "nonlinear", 0, 0, "nonlinear|linear",
              "A plate that stiffens under body weight, or Kirchhoff's (not contact=gaps)."},
    UriOption{"noise_mv", Number, "3", 0, 1000, "", "White noise of every sensor and extra channel, rms."},
    UriOption{"bits", Integer, "11", 11, 16, "", "Resolution of the converter."},
    shared_option::kRange,
    shared_option::kClock,
    shared_option::kGainSpread,
    UriOption{"gap_spread_mm", Number, "0.02", 0, 1, "", "Unloaded gaps differ from the nominal one by up to this."},
    shared_option::kSensors,
    UriOption{"extra", Integer, "0", 0, 31, "", "Further channels that carry only noise, for load tests."},
    UriOption{"truth", Integer, "1", 0, 1, "", "1: auxiliary channels true_ml_mm, true_ap_mm and true_load_n."},
    shared_option::kFault,
    shared_option::kFaultAt,
    shared_option::kFaultFor,
    shared_option::kFaultChannel,
};

constexpr std::array kFloorDependencies = {
    Dependency{"weight_n", "contact", "feet|one_foot"},
    Dependency{"stance_width_mm", "contact", "feet"},
    Dependency{"cop", "contact", "feet|one_foot"},
    Dependency{"load_n", "contact", "point"},
    Dependency{"x_mm", "contact", "feet|one_foot|point"},
    Dependency{"y_mm", "contact", "feet|one_foot|point"},
    Dependency{"step_off_s", "contact", "feet|one_foot|point"},
    Dependency{"weights", "contact", "weights"},
    Dependency{"gaps_mm", "contact", "gaps"},
    Dependency{"hold_s", "contact", "weights|gaps"},
    Dependency{"plate", "contact", "feet|one_foot|point|weights"},
    Dependency{"pause_s", "contact", "weights|gaps"},
    Dependency{"ramp_s", "contact", "weights|gaps"},
    Dependency{"gap_spread_mm", "contact", "feet|one_foot|point|weights"},
    shared_option::kFaultChannelNeeds,
};

core::Status check_contact(const DeviceUri& uri, const UriOptions& options) {
  DTS_TRY(check_dependencies(uri, options, kFloorDependencies));
  const std::string& contact = options.text("contact");
  for (const auto& [kind, option] : {std::pair{"weights", "weights"}, std::pair{"gaps", "gaps_mm"}}) {
    if (contact != kind || options.is_given(option)) continue;
    return refuse(uri, ErrorCode::InvalidArgument, "contact=" + contact + " needs " + option + "=...");
  }
  const bool has_end = !options.text("cop").empty() || is_one_of("weights|gaps", contact);
  if (options.is_given("loop") && !has_end) {
    return refuse(uri, ErrorCode::InvalidArgument, "loop has an effect only with cop=FILE or contact=weights|gaps");
  }
  return {};
}

FloorContact floor_contact(const std::string& word) {
  if (word == "one_foot") return FloorContact::OneFoot;
  if (word == "point") return FloorContact::Point;
  if (word == "weights") return FloorContact::Weights;
  return word == "gaps" ? FloorContact::Gaps : FloorContact::Feet;
}

PlacementTimes placement(const UriOptions& options) {
  return {.first_s = options.number("step_on_s"),
          .ramp_s = options.number("ramp_s"),
          .hold_s = options.number("hold_s"),
          .pause_s = options.number("pause_s"),
          .repeats = options.number("loop") == 1.0};
}

/// Rejects a total duration of almost 0: the weights would change infinitely fast.
core::Status check_placement(const DeviceUri& uri, const PlacementTimes& times) {
  if (2.0 * times.ramp_s + times.hold_s + times.pause_s >= 0.001) return {};
  return refuse(uri, ErrorCode::InvalidArgument, "ramp_s, hold_s and pause_s together are shorter than 1 ms");
}

physics::ContactKind contact_kind(FloorContact contact) {
  switch (contact) {
    case FloorContact::OneFoot: return physics::ContactKind::OneFoot;
    case FloorContact::Point: return physics::ContactKind::Point;
    case FloorContact::Feet:
    case FloorContact::Weights:
    case FloorContact::Gaps: break;
  }
  return physics::ContactKind::Feet;
}

physics::Stance stance(const UriOptions& options, std::uint64_t seed) {
  physics::Stance result;
  result.kind = contact_kind(floor_contact(options.text("contact")));
  result.load = core::Newtons{options.number(result.kind == physics::ContactKind::Point ? "load_n" : "weight_n")};
  result.centre_ml = core::Millimetres{options.number("x_mm")};
  result.centre_ap = core::Millimetres{options.number("y_mm")};
  result.width = core::Millimetres{options.number("stance_width_mm")};
  result.step_on_s = options.number("step_on_s");
  result.step_off_s = options.number("step_off_s");
  result.seed = seed;
  return result;
}

core::Status check_channels(const DeviceUri& uri, const FloorOptions& options, std::size_t rig_sensors) {
  if (options.sensors < 1 || options.sensors > rig_sensors) {
    return refuse(
        uri, ErrorCode::InvalidArgument,
        "sensors = " + std::to_string(options.sensors) + ", but the rig has " + std::to_string(rig_sensors) + " (more channels: extra=N)");
  }
  const std::size_t channels = options.converted_channels() + (options.has_truth ? kTruthChannels : 0);
  if (channels > core::kMaxChannels) {
    return refuse(uri, ErrorCode::LimitExceeded,
                  std::to_string(channels) + " channels with sensors, extra and truth; at most " + std::to_string(core::kMaxChannels));
  }
  return {};
}

}  // namespace

std::span<const UriOption> floor_option_table() { return kFloorTable; }

core::Result<FloorOptions> read_floor_options(const DeviceUri& uri, std::size_t rig_sensors) {
  DTS_TRY_ASSIGN(const auto options, UriOptions::read(uri, kFloorTable));
  DTS_TRY(check_contact(uri, options));

  FloorOptions result;
  result.seed = static_cast<std::uint64_t>(options.number("seed"));
  result.contact = floor_contact(options.text("contact"));
  result.stance = stance(options, result.seed);
  result.cop_file = options.text("cop");
  result.weights_file = options.text("weights");
  if (options.is_given("gaps_mm")) result.gaps_mm = options.numbers("gaps_mm");
  result.placement = placement(options);
  DTS_TRY(check_placement(uri, result.placement));
  result.is_repeated = result.placement.repeats;
  result.is_plate_stiffening = options.text("plate") == "nonlinear";
  result.daq = {options.number("range_v"), static_cast<int>(options.number("bits")), options.number("noise_mv") * kMillivolt, result.seed};
  result.clock_error_ppm = options.number("clock_ppm");
  result.gain_spread = options.number("gain_spread");
  result.gap_spread_mm = options.number("gap_spread_mm");
  result.sensors = static_cast<std::size_t>(options.number("sensors"));
  if (result.sensors == 0) result.sensors = rig_sensors;
  result.extra = static_cast<std::size_t>(options.number("extra"));
  result.has_truth = options.number("truth") == 1.0;
  DTS_TRY(check_channels(uri, result, rig_sensors));
  DTS_TRY_ASSIGN(result.fault, read_fault(uri, options, result.converted_channels()));
  return result;
}

}  // namespace dts::device::sim
