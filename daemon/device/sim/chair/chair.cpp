// SPDX-License-Identifier: Apache-2.0
#include "device/sim/chair/chair.h"

#include <string>
#include <utility>

#include "device/sim/chair/chair_options.h"
#include "device/sim/chair/chair_scene.h"
#include "device/sim/sim_device.h"
#include "physics/rig_model.h"

namespace dts::device::sim {
namespace {

constexpr double kLargestFlexionDeg = 120.0;
constexpr double kLargestSeatLoadN = 10'000.0;  // above the load of the heaviest person in the fastest movement

DeviceDescription describe(const DeviceUri& uri, const ChairOptions& options, const dts::sim::Daq& daq, const physics::Plate& plate) {
  DeviceDescription description;
  description.uri = uri.text;
  description.model = "Simulated chair";
  description.serial = "sim-chair-" + std::to_string(options.seed);
  description.minimum_rate_hz = kMinimumRateHz;
  description.maximum_rate_hz = kMaximumRateHz;
  const auto add = [&](std::string name, ChannelRole role) {
    description.channels.push_back({std::move(name), "V", role, daq.minimum_v(), daq.maximum_v(), daq.step_v()});
  };
  for (std::size_t i = 0; i < options.sensors; ++i) add("ch" + std::to_string(i), ChannelRole::Sensor);
  for (std::size_t i = 0; options.has_emg && i < kEmgChannels; ++i) add(std::string(kEmgNames[i]), ChannelRole::Auxiliary);
  if (!options.has_truth) return description;
  description.channels.push_back({"true_trunk_deg", "deg", ChannelRole::Auxiliary, -kLargestFlexionDeg, kLargestFlexionDeg, 0.0});
  description.channels.push_back({"true_y_mm", "mm", ChannelRole::Auxiliary, 0.0, plate.b.value, 0.0});
  description.channels.push_back({"true_load_n", "N", ChannelRole::Auxiliary, 0.0, kLargestSeatLoadN, 0.0});
  return description;
}

}  // namespace

core::Result<std::unique_ptr<Device>> create_chair(const DeviceUri& uri, const DeviceContext& context) {
  DTS_TRY_ASSIGN(const auto options, read_chair_options(uri, context.rig.sensors.size()));
  auto scene = ChairScene::create(options, context.rig);
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

core::Result<dts::sim::SeatedPersonOptions> chair_person(const DeviceUri& uri, const physics::RigModel& rig) {
  DTS_TRY_ASSIGN(const auto options, read_chair_options(uri, rig.sensors.size()));
  return options.person;
}

}  // namespace dts::device::sim
