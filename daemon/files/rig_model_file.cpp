// SPDX-License-Identifier: Apache-2.0
#include "files/rig_model_file.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "core/block.h"

namespace dts::files {
namespace {

constexpr double kLongestSideMm = 5000.0;
constexpr std::size_t kMostSensors = 16;

std::optional<physics::SensorCurve> read_curve(const std::string& file, Problems& problems) {
  const auto table = parse_toml(file, problems);
  if (!table) return std::nullopt;
  TomlReader reader(&*table, "", file, problems);
  reader.require("name");
  const std::string name = reader.text("name", "unnamed");
  std::vector<physics::CurvePoint> points;
  for (TomlReader& point : reader.tables("point")) {
    point.require("gap_mm");
    point.require("volts");
    points.push_back({.gap = {point.number("gap_mm", 0.0, 0.0, 1000.0)}, .volts = {point.number("volts", 0.0, -100.0, 100.0)}});
    point.finish();
  }
  reader.finish();
  auto curve = physics::SensorCurve::create(name, std::move(points));
  if (curve) return std::move(*curve);
  reader.report("", core::to_string(curve.error()));
  return std::nullopt;
}

/// Sensor files are read once per rig, however many sensors share them.
class CurveShelf {
 public:
  explicit CurveShelf(std::string rig_file, Problems& problems)
      : folder_(std::filesystem::path(rig_file).parent_path()), problems_(problems) {}

  const std::optional<physics::SensorCurve>& get(const std::string& name) {
    const auto [position, is_new] = curves_.try_emplace(name);
    if (is_new) position->second = read_curve((folder_ / name).lexically_normal().string(), problems_);
    return position->second;
  }

 private:
  std::filesystem::path folder_;
  Problems& problems_;
  std::map<std::string, std::optional<physics::SensorCurve>> curves_;
};

void read_sensors(TomlReader& top, RigModelFile& rig, Problems& problems) {
  CurveShelf shelf(top.file(), problems);
  auto readers = top.tables("sensor");
  if (readers.empty() || readers.size() > kMostSensors) {
    top.report("sensor",
               "a rig has 1 to " + std::to_string(kMostSensors) + " [[sensor]] tables, this one " + std::to_string(readers.size()));
  }
  for (TomlReader& reader : readers) {
    for (const char* key : {"label", "x_mm", "y_mm", "curve"}) reader.require(key);
    physics::SensorModel sensor{.label = reader.text("label", ""),
                                .position = {.x = {reader.number("x_mm", 0.0, 0.0, rig.model.plate.a.value)},
                                             .y = {reader.number("y_mm", 0.0, 0.0, rig.model.plate.b.value)}},
                                .curve = physics::SensorCurve::hoa1405_assumed()};
    const auto channel = static_cast<std::size_t>(
        reader.integer("channel", static_cast<std::int64_t>(rig.sensor_channels.size()), 0, core::kMaxChannels - 1));
    const std::string curve_file = reader.text("curve", "");
    if (!curve_file.empty()) {
      if (const auto& curve = shelf.get(curve_file)) sensor.curve = *curve;
    }
    sensor.unloaded_gap = {reader.number("unloaded_gap_mm", 12.0, sensor.curve.minimum_gap().value, sensor.curve.maximum_gap().value)};
    if (std::ranges::find(rig.sensor_channels, channel) != rig.sensor_channels.end()) {
      reader.report("channel", "channel " + std::to_string(channel) + " already belongs to another sensor");
    }
    if (std::ranges::find(rig.model.sensors, sensor.label, &physics::SensorModel::label) != rig.model.sensors.end()) {
      reader.report("label", "another sensor is labelled '" + sensor.label + "' too");
    }
    rig.sensor_channels.push_back(channel);
    rig.model.sensors.push_back(std::move(sensor));
    reader.finish();
  }
}

}  // namespace

physics::Plate read_plate(TomlReader reader) {
  physics::Plate plate;
  for (const char* key : {"a_mm", "b_mm", "h_mm", "e_pa", "nu"}) reader.require(key);
  plate.a = {reader.number("a_mm", plate.a.value, 10.0, kLongestSideMm)};
  plate.b = {reader.number("b_mm", plate.b.value, 10.0, kLongestSideMm)};
  plate.h = {reader.number("h_mm", plate.h.value, 0.1, 100.0)};
  plate.e_pa = reader.number("e_pa", plate.e_pa, 1e6, 1e13);
  plate.nu = reader.number("nu", plate.nu, -0.99, 0.499);
  reader.finish();
  return plate;
}

physics::Support read_support(TomlReader reader, const physics::Plate& plate) {
  physics::Support support;
  if (reader.choice("kind", {"corner", "edges"}) == "edges") support.kind = physics::SupportKind::Edges;
  support.inset = {reader.number("inset_mm", 0.0, 0.0, std::min(plate.a.value, plate.b.value) / 2.0 - 1.0)};
  reader.finish();
  return support;
}

RigModelFile read_rig_model(TomlReader& top, Problems& problems) {
  RigModelFile rig;
  rig.model.plate = read_plate(top.table("plate"));
  rig.model.support = read_support(top.table("support"), rig.model.plate);
  read_sensors(top, rig, problems);
  return rig;
}

}  // namespace dts::files
