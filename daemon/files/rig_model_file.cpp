// SPDX-License-Identifier: Apache-2.0
#include "files/rig_model_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/block.h"
#include "files/force_plate_file.h"
#include "files/sensor_curve_file.h"

namespace dts::files {
namespace {

// The same ranges as in physics::check_plate and check_support, checked here to report the place in the file. A test compares them.
constexpr double kShortestSideMm = 10.0;
constexpr double kLongestSideMm = 10'000.0;
constexpr int kLargestSideRatio = 20;
constexpr double kThinnestMm = 0.01;
constexpr double kThickest = 0.2;  ///< Fraction of the shorter side. Above it, thin-plate theory is invalid.

/// Thesis 4.3: distance of the unloaded plate from the sensors.
constexpr double kUnloadedGapMm = 12.0;
constexpr std::size_t kMostSensors = 16;

/// Reads a number in a range; the values in `excluded` (one end or both) are not allowed.
double number_off(std::initializer_list<double> excluded, TomlReader& reader, std::string_view key, double fallback, double minimum,
                  double maximum) {
  const double value = reader.number(key, fallback, minimum, maximum);
  if (std::ranges::find(excluded, value) == excluded.end()) return value;
  std::ostringstream text;
  text << key << " = " << value << " is out of range; allowed: " << minimum << " .. " << maximum << " without " << value;
  reader.report(key, text.str());
  return fallback;
}

/// Reads each sensor file only once per rig, even if several sensors use it.
class CurveShelf {
 public:
  CurveShelf(References references, Problems& problems) : references_(references), problems_(problems) {}

  /// Returns the curve of a sensor, and what is known of it; nothing if it cannot be read.
  std::optional<SensorCurveFile> get(TomlReader& sensor) {
    const toml::node* given = sensor.node("curve");
    const std::string name = given != nullptr ? given->value_or(std::string()) : std::string();
    if (const auto known = curves_.find(name); known != curves_.end() && references_ == References::Files) return known->second;
    std::optional<toml::table> parsed;
    std::optional<SensorCurveFile> file;
    if (auto reader = sensor.table_or_file("curve", references_, parsed)) file = read_sensor_curve(*reader, problems_);
    if (!name.empty()) curves_.emplace(name, file);
    return file;
  }

 private:
  References references_;
  Problems& problems_;
  std::map<std::string, std::optional<SensorCurveFile>> curves_;
};

void read_sensors(TomlReader& top, RigModelFile& rig, References references, Problems& problems) {
  CurveShelf shelf(references, problems);
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
    if (auto file = shelf.get(reader)) {
      sensor.curve = std::move(file->curve);
      if (file->calibration) sensor.curve_origin = std::move(file->calibration->origin);
    }
    const double nearest_mm = sensor.curve.minimum_gap().value;
    const double farthest_mm = sensor.curve.maximum_gap().value;
    sensor.unloaded_gap = {reader.number("unloaded_gap_mm", kUnloadedGapMm, nearest_mm, farthest_mm)};
    if (!reader.has("unloaded_gap_mm") && !(kUnloadedGapMm >= nearest_mm && kUnloadedGapMm <= farthest_mm)) {
      std::ostringstream text;
      text << "the curve covers gaps of " << nearest_mm << " .. " << farthest_mm << " mm, without the unloaded plate's " << kUnloadedGapMm
           << " mm (unloaded_gap_mm)";
      reader.report("curve", text.str());
    }
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

/// Returns the default names of the channels of a kind of force plate.
std::vector<std::string> channel_names(const std::string& kind, std::size_t count) {
  if (kind == "kistler8") return {"fx12", "fx34", "fy14", "fy23", "fz1", "fz2", "fz3", "fz4"};
  if (kind == "six_component") return {"fx", "fy", "fz", "mx", "my", "mz"};
  std::vector<std::string> names;
  for (std::size_t cell = 1; cell <= count; ++cell) names.push_back("cell" + std::to_string(cell));
  return names;
}

physics::PlateAxis read_axis(TomlReader& reader, std::string_view key) {
  const std::string word = reader.choice(key, {"+x", "-x", "+y", "-y"});
  if (word == "+x") return physics::PlateAxis::PlusX;
  if (word == "-x") return physics::PlateAxis::MinusX;
  return word == "+y" ? physics::PlateAxis::PlusY : physics::PlateAxis::MinusY;
}

/// Reads `channels`: the device channel of each channel of the plate; default: 0, 1, 2, ...
std::vector<std::size_t> read_channels(TomlReader& reader, std::size_t count) {
  std::vector<std::size_t> channels;
  for (const std::int64_t channel : reader.integers("channels", 0, core::kMaxChannels - 1)) {
    if (std::ranges::find(channels, static_cast<std::size_t>(channel)) != channels.end()) {
      reader.report("channels", "channel " + std::to_string(channel) + " is named twice");
    }
    channels.push_back(static_cast<std::size_t>(channel));
  }
  if (reader.has("channels") && channels.size() != count) {
    reader.report("channels",
                  "the plate has " + std::to_string(count) + " channels, but " + std::to_string(channels.size()) + " are named");
  }
  for (std::size_t channel = channels.size(); channel < count; ++channel) channels.push_back(channel);
  return channels;
}

constexpr std::string_view kChannelLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.";

/// Reads `names`: what the channels of the plate are called.
std::vector<std::string> read_names(TomlReader& reader, const std::string& kind, std::size_t count) {
  std::vector<std::string> names = reader.texts("names", channel_names(kind, count));
  if (names.size() != count) {
    reader.report("names", "the plate has " + std::to_string(count) + " channels, but " + std::to_string(names.size()) + " names");
  }
  for (std::size_t name = 0; name < names.size(); ++name) {
    if (names[name].empty() || names[name].find_first_not_of(kChannelLetters) != std::string::npos ||
        std::ranges::count(names, names[name]) > 1) {
      reader.report("names", "each name must be there once, and have only letters, digits, '_', '-' and '.'");
      break;
    }
  }
  return names;
}

/// Reads `size_mm`: the sides of the surface along the plate's x and y, as sides along ML and AP.
physics::Plate read_surface(TomlReader& reader, const physics::Mounting& mounting) {
  physics::Plate plate;
  reader.require("size_mm");
  const toml::node* const found = reader.node("size_mm");
  const std::vector<double> sides = found == nullptr ? std::vector<double>() : read_list(reader, "size_mm", found, 2, 2, kLongestSideMm);
  if (sides.size() != 2) return plate;
  if (*std::ranges::min_element(sides) < kShortestSideMm) reader.report("size_mm", "size_mm: a side is shorter than 10 mm");
  const bool is_ml_along_x = mounting.ml == physics::PlateAxis::PlusX || mounting.ml == physics::PlateAxis::MinusX;
  plate.a = {is_ml_along_x ? sides[0] : sides[1]};
  plate.b = {is_ml_along_x ? sides[1] : sides[0]};
  return plate;
}

/// Reads [force_plate] of a rig file: the keys of every force plate (force_plate_file.h), and those of its place in the rig: size_mm, ml,
/// ap, channels, names.
void read_force_plate_rig(TomlReader& top, RigModelFile& rig, Problems& problems) {
  for (const char* key : {"plate", "support", "sensor"}) {
    if (!top.has(key)) continue;
    static_cast<void>(top.node(key));
    top.report(key, std::string("a rig with [force_plate] has no [") + key + "]: remove it");
  }
  TomlReader reader = top.table("force_plate");
  const std::size_t known_problems = problems.size();
  for (const char* key : {"ml", "ap"}) reader.require(key);
  physics::Mounting mounting{.ml = read_axis(reader, "ml"), .ap = read_axis(reader, "ap")};
  const bool has_axes = problems.size() == known_problems;
  rig.model.plate = read_surface(reader, mounting);
  for (const char* key : {"channels", "names"}) static_cast<void>(reader.node(key));  // known, although read after the plate
  const auto file = read_force_plate(reader, problems);
  if (!file) return;
  mounting.is_z_down = file->is_z_down;
  // The surface is at az0 below 0, which is above the origin only if z points down.
  if (file->kind == "kistler8" && !file->is_z_down) reader.report("axes", "the channels of a kistler8 plate have z down: remove axes");
  if (const auto checked = physics::check(mounting); has_axes && !checked) reader.report("ml", core::to_string(checked.error()));
  const std::size_t count = file->plate.channel_count();
  rig.sensor_channels = read_channels(reader, count);
  rig.model.force_plate = physics::ForcePlateModel{.plate = file->plate,
                                                   .channel_names = read_names(reader, file->kind, count),
                                                   .mounting = mounting,
                                                   .polynomial = file->polynomial,
                                                   .tare_v = file->tare_volts};
}

}  // namespace

physics::Plate read_plate(TomlReader reader) {
  physics::Plate plate;
  for (const char* key : {"a_mm", "b_mm", "h_mm", "e_pa", "nu"}) reader.require(key);
  plate.a = {reader.number("a_mm", plate.a.value, kShortestSideMm, kLongestSideMm)};
  plate.b = {reader.number("b_mm", plate.b.value, kShortestSideMm, kLongestSideMm)};
  const double shorter_mm = std::min(plate.a.value, plate.b.value);
  if (std::max(plate.a.value, plate.b.value) > kLargestSideRatio * shorter_mm) {
    reader.report("a_mm", "[plate] a_mm and b_mm: one side is more than " + std::to_string(kLargestSideRatio) + " times the other");
  }
  plate.h = {reader.number("h_mm", std::min(plate.h.value, kThickest * shorter_mm), kThinnestMm, kThickest * shorter_mm)};
  plate.e_pa = reader.number("e_pa", plate.e_pa, 1e5, 1e13);
  plate.nu = number_off({-1.0, 0.5}, reader, "nu", plate.nu, -1.0, 0.5);
  reader.finish();
  return plate;
}

physics::Support read_support(TomlReader reader, const physics::Plate& plate) {
  using physics::SupportKind;
  constexpr std::array<std::pair<std::string_view, SupportKind>, 4> kKinds{{{"corner", SupportKind::Corner},
                                                                            {"edges", SupportKind::Edges},
                                                                            {"x-edges", SupportKind::XEdges},
                                                                            {"clamped", SupportKind::Clamped}}};
  physics::Support support;
  const std::string kind = reader.choice("kind", {kKinds[0].first, kKinds[1].first, kKinds[2].first, kKinds[3].first});
  support.kind = std::ranges::find(kKinds, kind, &std::pair<std::string_view, SupportKind>::first)->second;
  // With all point supports in the middle, the plate would tip.
  const double middle_mm = std::min(plate.a.value, plate.b.value) / 2.0;
  support.inset = {number_off({middle_mm}, reader, "inset_mm", 0.0, 0.0, middle_mm)};
  reader.finish();
  return support;
}

RigModelFile read_rig_model(TomlReader& top, Problems& problems, References references) {
  RigModelFile rig;
  if (top.has("force_plate")) {
    read_force_plate_rig(top, rig, problems);
    return rig;
  }
  rig.model.plate = read_plate(top.table("plate"));
  auto support = top.table("support");
  if (references == References::Files) support.require("kind");  // definitions in older recordings may lack it: corners, then
  rig.model.support = read_support(std::move(support), rig.model.plate);
  read_sensors(top, rig, references, problems);
  return rig;
}

}  // namespace dts::files
