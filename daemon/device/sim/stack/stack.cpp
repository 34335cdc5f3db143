// SPDX-License-Identifier: Apache-2.0
#include "device/sim/stack/stack.h"

#include <string>
#include <utility>

#include "device/sim/sim_device.h"
#include "device/sim/stack/stack_options.h"
#include "device/sim/stack/stack_scene.h"

namespace dts::device::sim {
namespace {

constexpr double kLargestLoadN = 2100.0;   // largest body weight of the option table, plus its fluctuation
constexpr double kLargestShearN = 2100.0;  // far above that of any sway

DeviceDescription describe(const DeviceUri& uri, const StackOptions& options, const dts::sim::Daq& daq, const physics::Plate& plate) {
  const bool is_plate = options.part == StackPart::Plate;
  DeviceDescription description;
  description.uri = uri.text;
  description.model = is_plate ? "Simulated force plate of a stack" : "Simulated floor platform of a stack";
  description.serial = (is_plate ? "sim-stack-plate-" : "sim-stack-floor-") + std::to_string(options.seed);
  description.minimum_rate_hz = kMinimumRateHz;
  description.maximum_rate_hz = kMaximumRateHz;
  const auto add = [&](std::string name, ChannelRole role) {
    description.channels.push_back({std::move(name), "V", role, daq.minimum_v(), daq.maximum_v(), daq.step_v()});
  };
  for (std::size_t i = 0; i < options.inputs; ++i) add("ch" + std::to_string(i), ChannelRole::Sensor);
  add("sync", ChannelRole::Auxiliary);
  if (!options.has_truth) return description;
  const auto add_truth = [&](const char* name, const char* unit, double minimum, double maximum) {
    description.channels.push_back({name, unit, ChannelRole::Auxiliary, minimum, maximum, 0.0});
  };
  add_truth("true_ml_mm", "mm", -plate.a.value / 2.0, plate.a.value / 2.0);
  add_truth("true_ap_mm", "mm", -plate.b.value / 2.0, plate.b.value / 2.0);
  add_truth("true_fx_n", "N", -kLargestShearN, kLargestShearN);
  add_truth("true_fy_n", "N", -kLargestShearN, kLargestShearN);
  add_truth("true_load_n", "N", 0.0, kLargestLoadN);
  return description;
}

}  // namespace

core::Result<std::unique_ptr<Device>> create_stack(const DeviceUri& uri, const DeviceContext& context) {
  DTS_TRY_ASSIGN(const auto options, read_stack_options(uri, context.rig));
  auto scene = StackScene::create(options, context.rig, context.clock);
  if (!scene) {
    core::Error error = scene.error();
    error.what = "device \"" + uri.text + "\": " + error.what;
    return tl::make_unexpected(error);
  }
  const dts::sim::Daq daq(options.daq);
  SimParts parts{.description = describe(uri, options, daq, context.rig.plate),
                 .converted_channels = options.converted_channels(),
                 .daq = daq,
                 .clock_error_ppm = options.clock_error_ppm,
                 .fault = options.fault,
                 .scene = std::move(*scene)};
  return std::make_unique<SimDevice>(std::move(parts), context.clock);
}

}  // namespace dts::device::sim
