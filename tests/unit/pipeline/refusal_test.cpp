// SPDX-License-Identifier: Apache-2.0
// What is said of an input that a stage cannot take, and of stages that are no pipeline: whole, in outputs/refusals.txt.
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "core/special_numbers.h"
#include "pipeline/pipeline.h"
#include "support/committed_text.h"
#include "unit/pipeline/chair_chain.h"
#include "unit/pipeline/standing_cop.h"
#include "unit/pipeline/standing_force.h"

namespace dts::pipeline {
namespace {

std::string answer(const std::string& name, const core::Error* error) {
  return name + ": " + (error == nullptr ? "taken" : std::string(core::name(error->code)) + ": " + core::to_string(*error)) + "\n";
}

core::StreamFormat format_of(double hz, const std::string& unit, std::size_t channels) {
  return make_signal(hz, unit, std::vector<std::vector<double>>(channels)).format;
}

/// What a calibration file of this rig would hold. Its ID does not depend on the processor, as the checksum of computed samples does.
physics::CopCalibration calibration_of(physics::CopMethod method, const physics::RigModel& rig) {
  const auto samples = physics::model_samples(method, rig, physics::PlateBehaviour::Stiffening).value();
  auto calibration = physics::calibrate_cop(method, samples, {.created_utc = "2026-01-31T12:00:00Z", .rig = "floor"}).value();
  calibration.id = "cop-20260131T120000Z-1a2b3c4d";
  return calibration;
}

/// The chair with so many sensors, of which the transient's are chosen.
std::function<void(StageSurroundings&)> chair(std::size_t sensors, std::optional<physics::RigModel::TransientSensors> chosen = {}) {
  return [=](StageSurroundings& has) {
    has.rig = chair_rig();
    has.rig.sensors.resize(sensors, has.rig.sensors.front());
    has.rig.transient_sensors = chosen;
  };
}

TEST(StageRefusal, OfEachInput_IsThatOfTheFile) {
  struct Row {
    StageConfig stage;
    core::StreamFormat format;
    std::function<void(StageSurroundings&)> change{};
  };
  core::StreamFormat renamed = swaying_cop(100.0, 0, 1).format;
  renamed.channels[1].name = "y_mm";
  core::StreamFormat two_units = format_of(100, "mm", 4);
  two_units.channels[3].unit = "V";
  const auto on_force_plate = [](StageSurroundings& has) { has.rig = with_force_plate(kistler_plate()); };
  core::StreamFormat of_cells = standing_force(0, 1, Faults::None).format;
  of_cells.channels = force_channels(false);
  std::string text;
  for (const Row& row : {
           Row{{"guard", {}}, format_of(100, "V", 3)},
           Row{{"guard", {}}, format_of(100, "V", 5)},
           Row{{"guard", {}}, format_of(100, "mm", 4)},
           Row{{"guard", {{"marker_channel", 1.0}}}, format_of(100, "V", 5)},
           Row{{"guard", {{"marker_channel", 0.0}}}, format_of(100, "V", 5)},
           Row{{"window_filter", {{"window_ms", 655.37}}}, format_of(100'000, "V", 1)},
           Row{{"window_filter", {{"window_ms", 655.36}}}, format_of(100'000, "V", 1)},
           Row{{"window_filter", {{"window_ms", 60'000.0}}}, format_of(100'000, "V", 1)},
           Row{{"linearise", {}}, format_of(100, "V", 3)},
           Row{{"linearise", {}}, format_of(100, "mm", 4)},
           Row{{"cop", {}}, format_of(100, "V", 4)},
           Row{{"cop", {}}, format_of(100, "mm", 3)},
           Row{{"cop", {}}, two_units},
           Row{{"cop", {}}, format_of(100, "mm", 4), [](StageSurroundings& has) { std::swap(has.rig.sensors[0], has.rig.sensors[1]); }},
           Row{{"cop", {{"estimator", "poly3"}}},
               format_of(100, "mm", 4),
               [](StageSurroundings& has) { has.cop_calibration = calibration_of(physics::CopMethod::Thesis, has.rig); }},
           Row{{"cop", {{"estimator", "thesis"}}},
               format_of(100, "mm", 4),
               [](StageSurroundings& has) { has.cop_calibration = calibration_of(physics::CopMethod::Thesis, has.rig); }},
           Row{{"transient", {}}, format_of(100, "V", 4), chair(4)},
           Row{{"transient", {}}, format_of(100, "mm", 3), chair(4)},
           Row{{"transient", {}}, format_of(100, "mm", 5), chair(5)},
           Row{{"transient", {}}, format_of(100, "mm", 4), chair(4, {{.rear = {0, 0}, .front = {2, 3}}})},
           Row{{"transient", {}}, format_of(100, "mm", 4), chair(4, {{.rear = {0, 1}, .front = {2, 4}}})},
           Row{{"transient", {}}, format_of(100, "mm", 4), chair(4, {{.rear = {3, 1}, .front = {2, 0}}})},
           Row{{"reach", {}}, format_of(100, "mm", 4)},
           Row{{"reach", {}}, transient_of({}, 0.0, 74.9).format},
           Row{{"reach", {}}, transient_of({}, 0.0, 75.0).format},
           Row{{"reach", {}}, transient_of({}, 0.0, 100'000.0).format},
           Row{{"steadiness", {}}, format_of(100, "V", 4)},
           Row{{"steadiness", {}}, format_of(100, "mm", 3)},
           Row{{"steadiness", {}}, renamed},
           Row{{"steadiness", {}}, swaying_cop(20.0, 0, 1).format},
           Row{{"steadiness", {}}, swaying_cop(20.001, 0, 1).format},
           Row{{"classify", {}}, transient_of({}, 0.0).format},
           Row{{"classify", {}}, transient_of({}, 0.0).format, [](StageSurroundings& has) { has.trunk_model.reset(); }},
           Row{{"force_plate", {}}, format_of(100, "V", 8)},
           Row{{"force_plate", {}}, format_of(100, "V", 7), on_force_plate},
           Row{{"force_plate", {}}, format_of(100, "N", 8), on_force_plate},
           Row{{"force_plate", {}}, format_of(100, "V", 8), on_force_plate},
           Row{{"force_cop", {}}, format_of(100, "N", 6), on_force_plate},
           Row{{"force_cop", {}}, standing_force(0, 1, Faults::None).format, on_force_plate},
           Row{{"force_cop", {{"top_mm", 50.0}}}, standing_force(0, 1, Faults::None).format, on_force_plate},
           Row{{"force_cop", {{"top_mm", 50.0}}}, of_cells, on_force_plate},
       }) {
    StageSurroundings has;
    if (row.change) row.change(has);
    const auto prepared = has.make(row.stage)->prepare(row.format, 64);
    std::ostringstream name;
    name << stage_text(row.stage) << " gets " << row.format.channels.size() << " channels in '" << row.format.channels[0].unit << "' at "
         << row.format.rate.hz() << " Hz";
    text += answer(name.str(), prepared ? nullptr : &prepared.error());
  }

  const std::vector<StageConfig> floor{{"guard", {}}, {"window_filter", {}}, {"linearise", {}}, {"cop", {}}};
  const auto create = [&text](const std::string& name, const std::vector<StageConfig>& stages, void (*change)(PipelineInput&)) {
    PipelineInput input{.rate = rate_hz(100),
                        .sensor_channels = {4, 1, 2, 3},
                        .aux_channels = {5, 0},
                        .aux_formats = {{.name = "emg", .unit = "V"}, {.name = "true_ml", .unit = "mm"}},
                        .max_block_scans = 16};
    change(input);
    StageSurroundings has;
    const auto pipeline = Pipeline::create(stages, input, has.context());
    text += answer(name, pipeline ? nullptr : &pipeline.error());
  };
  const auto same = [](PipelineInput&) {};
  create("the floor's", floor, same);
  create("none", {}, same);
  create("not from raw", {{"window_filter", {}}}, same);
  create("twice", {{"guard", {}}, {"window_filter", {}}, {"window_filter", {}}}, same);
  create("misspelt", {{"guard", {}}, {"window_filter", {{"window_scan", 3.0}}}}, same);
  create("not linearised", {{"guard", {}}, {"cop", {}}}, same);
  create("three sensors", floor, [](PipelineInput& input) { input.sensor_channels.pop_back(); });
  create("a channel twice", floor, [](PipelineInput& input) { input.sensor_channels.back() = 5; });
  create("channel 31", floor, [](PipelineInput& input) { input.sensor_channels.back() = 31; });
  create("channel 32", floor, [](PipelineInput& input) { input.sensor_channels.back() = 32; });
  create("a format is missing", floor, [](PipelineInput& input) { input.aux_formats.pop_back(); });
  create("blocks of 0", floor, [](PipelineInput& input) { input.max_block_scans = 0; });
  create("longest blocks", floor, [](PipelineInput& input) { input.max_block_scans = core::kMaxBlockScans; });
  create("longer blocks", floor, [](PipelineInput& input) { input.max_block_scans = core::kMaxBlockScans + 1; });
  create("trigger on a sensor", floor, [](PipelineInput& input) { input.trigger = TriggerInput{.channel = 4}; });
  create("trigger nowhere", floor, [](PipelineInput& input) { input.trigger = TriggerInput{.channel = 17}; });
  create("trigger on an auxiliary", floor, [](PipelineInput& input) { input.trigger = TriggerInput{.channel = 5}; });
  create("trigger without a level", floor, [](PipelineInput& input) { input.trigger = TriggerInput{.channel = 5, .level = core::kNaN}; });
  dts::test::expect_committed("unit/pipeline/outputs/refusals.txt", text);
}

}  // namespace
}  // namespace dts::pipeline
