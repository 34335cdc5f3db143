// SPDX-License-Identifier: Apache-2.0
// Rigs: as definitions out of recordings (a text that may name no file) and as files. One that is accepted is bounded, and its definition
// is accepted too and is its own definition.
#include <cmath>

#include "core/block.h"
#include "files/rig_file.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::rig {
namespace {

constexpr std::size_t kMostSensors = 16;
constexpr std::size_t kLargestDefinition = std::size_t{1} << 20U;

void check_rig(const pipeline::RigConfig& rig) {
  const physics::Plate& plate = rig.model.plate;
  for (const double size : {plate.a.value, plate.b.value, plate.h.value, plate.e_pa})
    promise(std::isfinite(size) && size > 0.0, "a plate has a size");
  promise(rig.rate.hz() >= 1.0 && rig.rate.hz() <= 20000.0, "a rate in range");
  promise(rig.block_scans >= 1 && rig.block_scans <= core::kMaxBlockScans, "a block has 1 to 4096 scans");
  const std::size_t inputs = physics::input_names(rig.model).size();
  promise(!rig.stages.empty() && inputs > 0 && inputs <= kMostSensors, "stages and sensors");
  promise(rig.sensor_channels.size() == inputs, "a channel for each sensor");
  promise(!rig.model.force_plate || rig.model.sensors.empty(), "a force plate has no sensors");
  for (const std::size_t channel : rig.sensor_channels) promise(channel < core::kMaxChannels, "a channel that a block can have");
  for (const physics::SensorModel& sensor : rig.model.sensors) {
    promise(sensor.position.x.value >= 0.0 && sensor.position.x.value <= plate.a.value, "sensors are under the plate");
    promise(std::isfinite(sensor.curve.volts(sensor.unloaded_gap).value), "an unloaded sensor has a voltage");
  }
  promise(!rig.cop_calibration || rig.cop_calibration->estimator.sensor_count() == rig.model.sensors.size(), "a calibration of this rig");
  promise(std::isfinite(rig.sync_pulse_ms) && rig.sync_pulse_ms >= 0.0, "a pulse has a length");
  promise(rig.sync_pulse_every_ms == 0.0 || rig.sync_pulse_every_ms > rig.sync_pulse_ms, "a pulse ends before the next one");
}

void check_definition(const fuzz::Folder& folder, const std::string& text) {
  const std::string file = folder.file("rig.toml");
  fuzz::put_file(file, text);
  const auto definition = files::rig_definition(file);
  if (!definition) return;
  promise(definition->size() <= kLargestDefinition, "a definition fits into a recording");
  files::Problems problems;
  check_rig(files::read_rig_text(*definition, "definition", problems));
  promise(problems.empty(), "a definition can be read");
  fuzz::put_file(file, *definition);
  const auto again = files::rig_definition(file);
  promise(again && *again == *definition, "a definition is its own definition");
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  static const fuzz::Folder folder;
  const std::string text = fuzz::text_of(bytes, size);
  files::Problems problems;
  const pipeline::RigConfig rig = files::read_rig_text(text, "definition", problems);
  for (const files::Problem& problem : problems) promise(!problem.text.empty(), "a problem says what it is");
  if (problems.empty()) check_rig(rig);
  check_definition(folder, text);
}

}  // namespace dts::fuzz::rig

DTS_FUZZ_TARGET(rig)
