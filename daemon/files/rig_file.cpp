// SPDX-License-Identifier: Apache-2.0
#include "files/rig_file.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "files/cop_calibration_file.h"
#include "files/rig_model_file.h"
#include "files/steadiness_model_file.h"
#include "files/trunk_model_file.h"

namespace dts::files {
namespace {

void read_acquisition(TomlReader reader, pipeline::RigConfig& config) {
  const double rate_hz = reader.number("rate_hz", 100.0, 1.0, 20000.0);
  config.rate = core::Rate::from_hz(rate_hz).value();  // the line above ensures the range
  const double block_ms = reader.number("block_ms", 10.0, 0.05, 1000.0);
  const bool is_low_latency = reader.boolean("low_latency", false);
  config.block_scans = is_low_latency ? 1 : config.rate.scans_in_ms(block_ms);
  if (config.block_scans > core::kMaxBlockScans) {
    reader.report("block_ms", "a block would have " + std::to_string(config.block_scans) + " scans; at most " +
                                  std::to_string(core::kMaxBlockScans) + " are supported: lower block_ms or rate_hz");
  }
  reader.finish();
}

/// Reads `calibration = "file.toml"`, relative to the rig file; `dtsctl calibrate cop` or `dtslab cop fit` writes this file. In a rig
/// definition it is a table.
std::optional<physics::CopCalibration> read_calibration(TomlReader& top, const physics::RigModel& model, References references,
                                                        Problems& problems) {
  std::optional<toml::table> parsed;
  auto reader = top.table_or_file("calibration", references, parsed);
  if (!reader) return std::nullopt;
  auto calibration = read_cop_calibration(*reader, problems);
  if (!calibration) return std::nullopt;
  const std::size_t sensors = calibration->estimator.sensor_count();
  if (sensors != model.sensors.size()) {
    top.report("calibration", "calibration '" + calibration->id + "' is for " + std::to_string(sensors) + " sensors, the rig has " +
                                  std::to_string(model.sensors.size()));
  }
  return calibration;
}

/// If the rig has a calibration, the cop stage uses its estimator: the stage's option `estimator` must be absent or the same.
void settle_estimator(TomlReader& reader, pipeline::StageConfig& stage, const pipeline::RigConfig& config) {
  if (stage.id != "cop" || !config.cop_calibration) return;
  const std::string& id = config.cop_calibration->id;
  const std::string method(physics::to_string(config.cop_calibration->estimator.method()));
  const auto [option, is_new] = stage.options.try_emplace("estimator", method);
  if (is_new || option->second == pipeline::OptionValue(method)) return;
  reader.report("estimator", "the rig's calibration '" + id + "' is for estimator \"" + method +
                                 "\"; leave estimator out, or set it to the same method");
}

/// Reads `model = "file.toml"`, the trunk model; `dtslab reach train` writes this file. In a rig definition it is a table.
void read_model(TomlReader& top, pipeline::RigConfig& config, References references, Problems& problems) {
  std::optional<toml::table> parsed;
  auto reader = top.table_or_file("model", references, parsed);
  if (!reader) return;
  config.trunk_model = read_trunk_model(*reader, problems);
  if (config.trunk_model) config.trunk_model_text = trunk_model_text(*config.trunk_model);
}

bool has_stage(const pipeline::RigConfig& config, std::string_view id) {
  return std::ranges::any_of(config.stages, [id](const pipeline::StageConfig& stage) { return stage.id == id; });
}

/// Reads `transient_sensors = ["2", "5", "10", "13"]`: rear left, rear right, front left, front right (thesis 5.3.2).
void read_transient_sensors(TomlReader& top, pipeline::RigConfig& config) {
  constexpr std::string_view kKey = "transient_sensors";
  const std::vector<std::string> labels = top.texts(std::string(kKey), {});
  if (!top.has(kKey)) return;
  physics::RigModel::TransientSensors chosen;
  const std::array places{&chosen.rear[0], &chosen.rear[1], &chosen.front[0], &chosen.front[1]};
  if (labels.size() != places.size()) return top.report(kKey, "name four sensors: rear left, rear right, front left, front right");
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto found = std::ranges::find(config.model.sensors, labels[k], &physics::SensorModel::label);
    if (found == config.model.sensors.end()) return top.report(kKey, "there is no sensor labelled '" + labels[k] + "'");
    if (std::ranges::count(labels, labels[k]) > 1) return top.report(kKey, "sensor '" + labels[k] + "' is named twice");
    *places[k] = static_cast<std::size_t>(found - config.model.sensors.begin());
  }
  const auto at = [&config](std::size_t index) { return config.model.sensors[index].position; };
  const bool is_behind =
      std::max(at(chosen.rear[0]).y.value, at(chosen.rear[1]).y.value) < std::min(at(chosen.front[0]).y.value, at(chosen.front[1]).y.value);
  const bool is_left = at(chosen.rear[0]).x.value < at(chosen.rear[1]).x.value && at(chosen.front[0]).x.value < at(chosen.front[1]).x.value;
  if (!is_behind || !is_left)
    return top.report(kKey, "the order is rear left, rear right, front left, front right; y grows to the front, x to the right");
  config.model.transient_sensors = chosen;
}

void read_stages(TomlReader& top, pipeline::RigConfig& config) {
  for (TomlReader& reader : top.tables("stage")) {
    pipeline::StageConfig stage;
    reader.require("id");
    stage.id = reader.text("id", "");
    for (const std::string& key : reader.remaining_keys()) {
      const toml::node* value = reader.node(key);
      if (value->is_string()) {
        stage.options.emplace(key, *value->value<std::string>());
      } else if (value->is_number()) {
        stage.options.emplace(key, *value->value<double>());
      } else {
        reader.report(key, "an option must be a number or a text in quotes");
      }
    }
    settle_estimator(reader, stage, config);
    for (const std::string& problem : pipeline::check_stage(stage)) reader.report("id", problem);
    config.stages.push_back(std::move(stage));
    reader.finish();
  }
  if (config.cop_calibration && !has_stage(config, "cop")) {
    top.report("calibration", "the rig has no [[stage]] \"cop\" that could use its calibration");
  }
  if (config.trunk_model && !has_stage(config, "classify")) {
    top.report("model", "the rig has no [[stage]] \"classify\" that could use its model");
  }
  if (!config.trunk_model && !top.has("model") && has_stage(config, "classify")) {
    top.report("", "[[stage]] \"classify\" needs a model: add model = \"FILE.toml\", see dtslab reach train");
  }
  if (config.steadiness_model && !has_stage(config, "cop")) {
    top.report("steadiness", "the rig has no [[stage]] \"cop\": there is nothing that its steadiness model could decide");
  }
  if (config.stages.empty()) top.report("", "the rig has no [[stage]]: at least \"guard\" is needed");
}

pipeline::TriggerEdges read_edges(TomlReader& reader) {
  const std::string word = reader.choice("edges", {"rising", "falling", "both"});
  if (word == "falling") return pipeline::TriggerEdges::Falling;
  return word == "both" ? pipeline::TriggerEdges::Both : pipeline::TriggerEdges::Rising;
}

/// Reads `[trigger]`: the device channel with the trigger signal of another instrument.
void read_trigger(TomlReader& top, pipeline::RigConfig& config, const Problems& problems) {
  if (!top.has("trigger")) return;
  TomlReader reader = top.table("trigger");
  reader.require("channel");
  pipeline::TriggerInput input;
  const std::size_t problems_before = problems.size();
  input.channel = static_cast<std::size_t>(reader.integer("channel", 0, 0, core::kMaxChannels - 1));
  const bool is_channel = reader.has("channel") && problems.size() == problems_before;
  input.level = reader.number("level", input.level, -1e6, 1e6);
  input.hysteresis = reader.number("hysteresis", input.hysteresis, 0.0, 1e6);
  input.edges = read_edges(reader);
  const bool is_sensor = std::ranges::find(config.sensor_channels, input.channel) != config.sensor_channels.end();
  if (is_channel && is_sensor) {
    reader.report("channel", "channel " + std::to_string(input.channel) + " belongs to a sensor");
  }
  reader.finish();
  config.trigger = input;
}

/// Returns the streams that the table `verb` names, for example `[record] streams`; an empty list means all streams of the rig. A recording
/// may leave out any stream except raw, because all others can be computed again from it.
std::vector<std::string> read_streams(TomlReader& top, const std::string& verb) {
  TomlReader reader = top.table(verb);
  std::vector<std::string> streams = reader.texts("streams", {});
  const toml::node* list = reader.node("streams");
  if (list != nullptr && list->is_array() && list->as_array()->empty()) {
    reader.report("streams", "[" + verb + "] streams is empty; leave it out to " + verb + " all streams of the rig");
  }
  reader.finish();
  return streams;
}

void read_sync_pulse(TomlReader& top, pipeline::RigConfig& config) {
  constexpr double kLeastLowMs = 100.0;  // the control thread changes the line at most every 50 ms
  TomlReader reader = top.table("session");
  config.sync_pulse_ms = reader.number("sync_pulse_ms", 0.0, 0.0, 10'000.0);
  config.sync_pulse_every_ms = reader.number("sync_pulse_every_ms", 0.0, 0.0, 60'000.0);
  if (config.sync_pulse_every_ms > 0.0 && config.sync_pulse_ms == 0.0) {
    reader.report("sync_pulse_every_ms", "[session] sync_pulse_every_ms needs a pulse: set sync_pulse_ms");
  } else if (config.sync_pulse_every_ms > 0.0 && config.sync_pulse_every_ms < config.sync_pulse_ms + kLeastLowMs) {
    reader.report("sync_pulse_every_ms", "[session] sync_pulse_every_ms must be at least 100 ms longer than sync_pulse_ms");
  }
  reader.finish();
}

pipeline::RigConfig read_rig(const toml::table& table, const std::string& name, References references, Problems& problems) {
  pipeline::RigConfig config;
  TomlReader top(&table, "", name, problems);
  config.kind = top.choice("kind", {"floor", "chair"});
  auto [model, channels] = read_rig_model(top, problems, references);
  config.model = std::move(model);
  config.sensor_channels = std::move(channels);
  read_transient_sensors(top, config);
  read_acquisition(top.table("acquire"), config);
  read_trigger(top, config, problems);
  read_sync_pulse(top, config);
  config.cop_calibration = read_calibration(top, config.model, references, problems);
  read_model(top, config, references, problems);
  config.steadiness_model = read_steadiness_model(top, references);
  read_stages(top, config);
  config.published = read_streams(top, "publish");
  config.recorded = read_streams(top, "record");
  top.finish();
  return config;
}

}  // namespace

pipeline::RigConfig read_rig_file(const std::string& file, Problems& problems) {
  const auto table = parse_toml(file, problems);
  return table ? read_rig(*table, file, References::Files, problems) : pipeline::RigConfig();
}

RigToCalibrate read_rig_to_calibrate(const std::string& file, Problems& problems) {
  const auto table = parse_toml(file, problems);
  if (!table) return {};
  TomlReader top(&*table, "", file, problems);
  RigToCalibrate rig{.model = read_rig_model(top, problems).model, .calibration = {}};
  if (rig.model.force_plate) top.report("force_plate", "a force plate has the calibration of its maker: there is nothing to calibrate");
  rig.calibration = read_calibration(top, rig.model, References::Files, problems);
  for (TomlReader& stage : top.tables("stage")) {
    if (stage.text("id", "") != "cop") continue;
    const auto method = physics::parse_cop_method(stage.text("estimator", physics::to_string(rig.method)));
    if (!method) stage.report("estimator", core::to_string(method.error()));
    if (method) rig.method = *method;
  }
  if (rig.calibration) rig.method = rig.calibration->estimator.method();
  return rig;
}

pipeline::RigConfig read_rig_text(const std::string& text, const std::string& name, Problems& problems) {
  const auto table = parse_toml_text(text, name, problems);
  return table ? read_rig(*table, name, References::None, problems) : pipeline::RigConfig();
}

}  // namespace dts::files
