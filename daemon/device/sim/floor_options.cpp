// SPDX-License-Identifier: Apache-2.0
#include "device/sim/floor_options.h"

#include <array>

#include "core/block.h"

namespace dts::device::sim {
namespace {

using core::ErrorCode;
using enum OptionKind;

constexpr std::array kTable = {
    UriOption{"seed", Integer, "1", 0, 4294967295.0, "", "Chooses sway, noise, gains and gaps; the same seed gives the same data."},
    UriOption{"contact", Word, "feet", 0, 0, "feet|point", "A person on two feet, or a weight at one point."},
    UriOption{"weight_n", Number, "686", 50, 2000, "", "Body weight (contact=feet)."},
    UriOption{"load_n", Number, "490", 1, 2000, "", "Load of the weight (contact=point)."},
    UriOption{"x_mm", Number, "0", -1000, 1000, "", "ML position of the weight or of the stance, from the plate's centre."},
    UriOption{"y_mm", Number, "0", -1000, 1000, "", "AP position of the weight or of the stance, from the plate's centre."},
    UriOption{"stance_width_mm", Number, "200", 50, 600, "", "Between the middle lines of the feet."},
    UriOption{"step_on_s", Number, "2.5", 0, 86400, "", "First touch; the plate is empty before, so that it can be tared."},
    UriOption{"step_off_s", Number, "never", 0, kNever, "", "Begins to leave."},
    UriOption{"cop", File, "", 0, 0, "", "Recorded COP to repeat (CSV t_s,x_mm,y_mm) instead of synthetic sway."},
    UriOption{"loop", Integer, "0", 0, 1, "", "1: repeat the recording for ever; 0: step off at its end."},
    UriOption{"noise_mv", Number, "3", 0, 1000, "", "White noise of every sensor and extra channel, rms."},
    UriOption{"bits", Integer, "11", 11, 16, "", "Resolution of the converter."},
    UriOption{"range_v", Number, "5", 1, 10, "", "Range of the converter, to both sides of 0 V."},
    UriOption{"clock_ppm", Number, "0", -1000, 1000, "", "Error of the device's clock; positive runs fast."},
    UriOption{"gain_spread", Number, "0", 0, 0.5, "", "Sensor gains differ from 1 by up to this."},
    UriOption{"gap_spread_mm", Number, "0.02", 0, 1, "", "Unloaded gaps differ from the nominal one by up to this."},
    UriOption{"sensors", Integer, "0", 0, 32, "", "The first so many sensors of the rig; 0: all of them."},
    UriOption{"extra", Integer, "0", 0, 31, "", "Further channels that carry only noise, for load tests."},
    UriOption{"truth", Integer, "1", 0, 1, "", "1: auxiliary channels true_ml_mm, true_ap_mm and true_load_n."},
    UriOption{"fault", Word, "none", 0, 0, "none|unplug|overrun|stuck|silence", "What goes wrong."},
    UriOption{"fault_at_s", Number, "10", 0, 1e6, "", "Device time since start at which it goes wrong."},
    UriOption{"fault_for_s", Number, "2", 0.001, 86400, "", "For how long."},
    UriOption{"fault_channel", Integer, "0", 0, 31, "", "Channel that fault=stuck holds."},
};

constexpr double kMillivolt = 1e-3;
constexpr std::size_t kTruthChannels = 3;

/// An option that would silently do nothing unless another one is set is refused: it is probably a mistake.
struct Dependency {
  std::string_view option;
  std::string_view needs;
  std::string_view value;
};

constexpr std::array kDependencies = {
    Dependency{"weight_n", "contact", "feet"}, Dependency{"stance_width_mm", "contact", "feet"}, Dependency{"cop", "contact", "feet"},
    Dependency{"load_n", "contact", "point"},  Dependency{"fault_channel", "fault", "stuck"},
};

tl::unexpected<core::Error> refuse(const DeviceUri& uri, ErrorCode code, const std::string& why) {
  return core::fail(code, "device \"" + uri.text + "\": " + why);
}

core::Status check_dependencies(const DeviceUri& uri, const UriOptions& options) {
  for (const auto& [option, needs, value] : kDependencies) {
    if (!options.is_given(option) || options.text(needs) == value) continue;
    return refuse(uri, ErrorCode::InvalidArgument,
                  std::string(option) + " has a meaning only with " + std::string(needs) + "=" + std::string(value));
  }
  if (options.is_given("loop") && options.text("cop").empty()) {
    return refuse(uri, ErrorCode::InvalidArgument, "loop has a meaning only with cop=FILE");
  }
  for (const std::string_view option : {"fault_at_s", "fault_for_s"}) {
    if (!options.is_given(option) || options.text("fault") != "none") continue;
    return refuse(uri, ErrorCode::InvalidArgument, std::string(option) + " has a meaning only with fault=...");
  }
  return {};
}

FaultKind fault_kind(const std::string& word) {
  if (word == "unplug") return FaultKind::Unplug;
  if (word == "overrun") return FaultKind::Overrun;
  if (word == "stuck") return FaultKind::Stuck;
  return word == "silence" ? FaultKind::Silence : FaultKind::None;
}

physics::Stance stance(const UriOptions& options, std::uint64_t seed) {
  physics::Stance result;
  const bool is_point = options.text("contact") == "point";
  result.kind = is_point ? physics::ContactKind::Point : physics::ContactKind::Feet;
  result.load = core::Newtons{options.number(is_point ? "load_n" : "weight_n")};
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
  if (options.fault.kind == FaultKind::Stuck && options.fault.channel >= options.converted_channels()) {
    return refuse(uri, ErrorCode::InvalidArgument,
                  "fault_channel = " + std::to_string(options.fault.channel) + ", but there are " +
                      std::to_string(options.converted_channels()) + " converted channels, counted from 0");
  }
  return {};
}

}  // namespace

std::span<const UriOption> floor_option_table() { return kTable; }

core::Result<FloorOptions> read_floor_options(const DeviceUri& uri, std::size_t rig_sensors) {
  auto read = UriOptions::read(uri, kTable);
  if (!read) return tl::make_unexpected(read.error());
  const UriOptions& options = *read;
  if (auto checked = check_dependencies(uri, options); !checked) return tl::make_unexpected(checked.error());

  FloorOptions result;
  result.seed = static_cast<std::uint64_t>(options.number("seed"));
  result.stance = stance(options, result.seed);
  result.cop_file = options.text("cop");
  result.is_cop_repeated = options.number("loop") == 1.0;
  result.daq = {options.number("range_v"), static_cast<int>(options.number("bits")), options.number("noise_mv") * kMillivolt, result.seed};
  result.clock_error_ppm = options.number("clock_ppm");
  result.gain_spread = options.number("gain_spread");
  result.gap_spread_mm = options.number("gap_spread_mm");
  result.sensors = static_cast<std::size_t>(options.number("sensors"));
  if (result.sensors == 0) result.sensors = rig_sensors;
  result.extra = static_cast<std::size_t>(options.number("extra"));
  result.has_truth = options.number("truth") == 1.0;
  result.fault = {fault_kind(options.text("fault")), options.number("fault_at_s"), options.number("fault_for_s"),
                  static_cast<std::size_t>(options.number("fault_channel"))};
  if (auto checked = check_channels(uri, result, rig_sensors); !checked) return tl::make_unexpected(checked.error());
  return result;
}

}  // namespace dts::device::sim
