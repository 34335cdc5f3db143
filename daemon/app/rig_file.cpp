// SPDX-License-Identifier: Apache-2.0
#include "app/rig_file.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "files/cop_calibration_file.h"
#include "files/rig_model_file.h"

namespace dts::app {
namespace {

void read_acquisition(files::TomlReader reader, session::RigConfig& config) {
  const double rate_hz = reader.number("rate_hz", 100.0, 1.0, 20000.0);
  config.rate = core::Rate::from_hz(rate_hz).value();  // in range by the line above
  const double block_ms = reader.number("block_ms", 20.0, 0.05, 1000.0);
  const bool is_low_latency = reader.boolean("low_latency", false);
  config.block_scans = is_low_latency ? 1 : config.rate.scans_in_ms(block_ms);
  if (config.block_scans > core::kMaxBlockScans) {
    reader.report("block_ms", "a block would have " + std::to_string(config.block_scans) + " scans; at most " +
                                  std::to_string(core::kMaxBlockScans) + " are supported: lower block_ms or rate_hz");
  }
  reader.finish();
}

/// `calibration = "file.toml"`, relative to the rig file: measured on this rig with `dtsctl calibrate cop` or `dtslab cop fit`.
void read_calibration(files::TomlReader& top, session::RigConfig& config, files::Problems& problems) {
  const std::string name = top.text("calibration", "");
  if (name.empty()) return;
  const auto file = (std::filesystem::path(top.file()).parent_path() / name).lexically_normal().string();
  config.cop_calibration = files::read_cop_calibration(file, problems);
  if (!config.cop_calibration) return;
  const std::size_t sensors = config.cop_calibration->estimator.sensor_count();
  if (sensors == config.model.sensors.size()) return;
  top.report("calibration", "calibration '" + config.cop_calibration->id + "' is for " + std::to_string(sensors) +
                                " sensors, the rig has " + std::to_string(config.model.sensors.size()));
}

/// The cop stage computes with the rig's calibration when there is one: a word about the estimator has to say the same.
void settle_estimator(files::TomlReader& reader, pipeline::StageConfig& stage, const session::RigConfig& config) {
  if (stage.id != "cop" || !config.cop_calibration) return;
  const auto& [id, origin, estimator, points, residuals, cross_validated] = *config.cop_calibration;
  const std::string method(physics::to_string(estimator.method()));
  const auto [option, is_new] = stage.options.try_emplace("estimator", method);
  if (is_new || option->second == pipeline::OptionValue(method)) return;
  reader.report("estimator", "the rig's calibration '" + id + "' is for estimator \"" + method + "\"; leave estimator out or say the same");
}

void read_stages(files::TomlReader& top, session::RigConfig& config) {
  for (files::TomlReader& reader : top.tables("stage")) {
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
        reader.report(key, "an option is a number or a text in quotes");
      }
    }
    settle_estimator(reader, stage, config);
    for (const std::string& problem : pipeline::check_stage(stage)) reader.report("id", problem);
    config.stages.push_back(std::move(stage));
    reader.finish();
  }
  const bool has_cop = std::ranges::any_of(config.stages, [](const pipeline::StageConfig& stage) { return stage.id == "cop"; });
  if (config.cop_calibration && !has_cop) top.report("calibration", "the rig has no [[stage]] \"cop\" that could use its calibration");
  if (config.stages.empty()) top.report("", "the rig has no [[stage]]: at least \"guard\" is needed");
}

pipeline::TriggerEdges read_edges(files::TomlReader& reader) {
  const std::string word = reader.choice("edges", {"rising", "falling", "both"});
  if (word == "falling") return pipeline::TriggerEdges::Falling;
  return word == "both" ? pipeline::TriggerEdges::Both : pipeline::TriggerEdges::Rising;
}

/// `[trigger]`: the device channel on which another instrument tells of itself.
void read_trigger(files::TomlReader& top, session::RigConfig& config, const files::Problems& problems) {
  if (!top.has("trigger")) return;
  files::TomlReader reader = top.table("trigger");
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

}  // namespace

session::RigConfig read_rig_file(const std::string& file, files::Problems& problems) {
  session::RigConfig config;
  const auto table = files::parse_toml(file, problems);
  if (!table) return config;
  files::TomlReader top(&*table, "", file, problems);
  config.kind = top.choice("kind", {"floor"});
  auto [model, channels] = files::read_rig_model(top, problems);
  config.model = std::move(model);
  config.sensor_channels = std::move(channels);
  read_acquisition(top.table("acquire"), config);
  read_trigger(top, config, problems);
  files::TomlReader sync = top.table("session");
  config.sync_pulse_ms = sync.number("sync_pulse_ms", 0.0, 0.0, 10'000.0);
  sync.finish();
  read_calibration(top, config, problems);
  read_stages(top, config);
  files::TomlReader publish = top.table("publish");
  config.published = publish.texts("streams", {"raw", "filtered", "deflection", "cop", "aux"});
  publish.finish();
  top.finish();
  return config;
}

}  // namespace dts::app
