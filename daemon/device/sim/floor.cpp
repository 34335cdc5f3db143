// SPDX-License-Identifier: Apache-2.0
#include "device/sim/floor.h"

#include "device/sim/bench_scenes.h"
#include "device/sim/floor_options.h"
#include "device/sim/option_checks.h"
#include "device/sim/person_scene.h"
#include "device/sim/sim_device.h"
#include "physics/rig_model.h"

namespace dts::device::sim {
namespace {

constexpr double kLargestFloorLoadN = 2100.0;  // largest body weight of the option table, plus its fluctuation

DeviceDescription describe(const DeviceUri& uri, const FloorOptions& options, const dts::sim::Daq& daq, const physics::Plate& plate) {
  DeviceDescription description;
  description.uri = uri.text;
  description.model = "Simulated floor platform";
  description.serial = "sim-floor-" + std::to_string(options.seed);
  description.minimum_rate_hz = kMinimumRateHz;
  description.maximum_rate_hz = kMaximumRateHz;
  const auto add = [&](std::string name, ChannelRole role) {
    description.channels.push_back({std::move(name), "V", role, daq.minimum_v(), daq.maximum_v(), daq.step_v()});
  };
  for (std::size_t i = 0; i < options.sensors; ++i) add("ch" + std::to_string(i), ChannelRole::Sensor);
  for (std::size_t i = 0; i < options.extra; ++i) add("extra" + std::to_string(i), ChannelRole::Auxiliary);
  if (!options.has_truth) return description;
  const double half_a = plate.a.value / 2.0;
  const double half_b = plate.b.value / 2.0;
  description.channels.push_back({"true_ml_mm", "mm", ChannelRole::Auxiliary, -half_a, half_a, 0.0});
  description.channels.push_back({"true_ap_mm", "mm", ChannelRole::Auxiliary, -half_b, half_b, 0.0});
  description.channels.push_back({"true_load_n", "N", ChannelRole::Auxiliary, 0.0, kLargestFloorLoadN, 0.0});
  return description;
}

core::Result<std::unique_ptr<Scene>> create_kind_of_scene(const FloorOptions& options, const physics::RigModel& rig) {
  switch (options.contact) {
    case FloorContact::Weights: return WeightsScene::create(options, rig);
    case FloorContact::Gaps: return GapsScene::create(options, rig);
    case FloorContact::Feet:
    case FloorContact::OneFoot:
    case FloorContact::Point: break;
  }
  return PersonScene::create(options, rig);
}

core::Result<std::unique_ptr<Scene>> create_scene(const DeviceUri& uri, const FloorOptions& options, const physics::RigModel& rig) {
  auto scene = create_kind_of_scene(options, rig);
  if (scene) return scene;
  core::Error error = scene.error();
  error.what = "device \"" + uri.text + "\": " + error.what;
  return tl::make_unexpected(error);
}

core::Result<FloorOptions> options_for(const DeviceUri& uri, const physics::RigModel& rig) {
  if (rig.force_plate && rig.sensors.empty()) {
    return refuse(uri, core::ErrorCode::InvalidArgument, "sim:floor has no force plate; use sim:stack?part=plate");
  }
  return read_floor_options(uri, rig.sensors.size());
}

}  // namespace

core::Result<std::unique_ptr<Device>> create_floor(const DeviceUri& uri, const DeviceContext& context) {
  DTS_TRY_ASSIGN(const auto options, options_for(uri, context.rig));
  DTS_TRY_ASSIGN(auto scene, create_scene(uri, options, context.rig));
  const dts::sim::Daq daq(options.daq);
  SimParts parts{.description = describe(uri, options, daq, context.rig.plate),
                 .converted_channels = options.converted_channels(),
                 .daq = daq,
                 .clock_error_ppm = options.clock_error_ppm,
                 .fault = options.fault,
                 .scene = std::move(scene)};
  return std::make_unique<SimDevice>(std::move(parts), context.clock);
}

core::Result<FloorScene> floor_scene(const DeviceUri& uri, const physics::RigModel& rig) {
  DTS_TRY_ASSIGN(const auto options, options_for(uri, rig));
  DTS_TRY_ASSIGN(auto scene, create_scene(uri, options, rig));
  const dts::sim::Daq daq(options.daq);
  return FloorScene{std::move(scene), options.sensors, describe(uri, options, daq, rig.plate).channels.size()};
}

}  // namespace dts::device::sim
