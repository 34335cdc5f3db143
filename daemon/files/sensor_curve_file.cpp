// SPDX-License-Identifier: Apache-2.0
#include "files/sensor_curve_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <sstream>
#include <utility>
#include <vector>

#include "files/toml_text.h"
#include "files/whole_file.h"

namespace dts::files {
namespace {

constexpr std::int64_t kMostSamples = 1'000'000'000;

SensorCalibrationFacts read_facts(TomlReader reader) {
  SensorCalibrationFacts facts;
  physics::SensorCurveOrigin& origin = facts.origin;
  for (const auto& [key, target] :
       {std::pair{"id", &facts.id}, std::pair{"created_utc", &origin.created_utc}, std::pair{"rig", &origin.rig},
        std::pair{"sensor", &origin.sensor}, std::pair{"daq_model", &origin.daq_model}, std::pair{"daq_serial", &origin.daq_serial},
        std::pair{"channel", &origin.channel}}) {
    *target = reader.short_text(key);
  }
  if (reader.has("range_v")) facts.range_v = reader.number("range_v", 0.0, 0.001, 1000.0);
  facts.residual_mv = reader.number("residual_mv", 0.0, 0.0, 1e6);
  if (reader.has("repeat_mv")) facts.repeat_mv = reader.number("repeat_mv", 0.0, 0.0, 1e6);
  facts.readings_per_gap = static_cast<std::size_t>(reader.integer("readings_per_gap", 1, 1, kMostSamples));
  facts.samples_per_point = static_cast<std::size_t>(reader.integer("samples_per_point", 1, 1, kMostSamples));
  reader.finish();
  return facts;
}

void put_text(std::ostream& out, const char* key, const std::string& text) {
  if (!text.empty()) out << key << " = " << toml_quoted(text) << '\n';
}

}  // namespace

std::optional<SensorCurveFile> read_sensor_curve(const std::string& file, Problems& problems) {
  const auto table = parse_toml(file, problems);
  if (!table) return std::nullopt;
  TomlReader reader(&*table, "", file, problems);
  return read_sensor_curve(reader, problems);
}

std::optional<SensorCurveFile> read_sensor_curve(TomlReader& reader, Problems& problems) {
  const std::size_t known_problems = problems.size();
  reader.require("name");
  const std::string name = reader.text("name", "unnamed");
  std::optional<SensorCalibrationFacts> facts;
  if (reader.has("calibration")) facts = read_facts(reader.table("calibration"));
  std::vector<physics::CurvePoint> points;
  for (TomlReader& point : reader.tables("point")) {
    point.require("gap_mm");
    point.require("volts");
    points.push_back({.gap = {point.number("gap_mm", 0.0, 0.0, 1000.0)}, .volts = {point.number("volts", 0.0, -100.0, 100.0)}});
    point.finish();
  }
  reader.finish();
  if (problems.size() > known_problems) return std::nullopt;
  auto curve = physics::SensorCurve::create(name, std::move(points));
  if (curve) return SensorCurveFile{.curve = std::move(*curve), .calibration = std::move(facts)};
  reader.report("", core::to_string(curve.error()));
  return std::nullopt;
}

SensorCalibrationFacts with_id(SensorCalibrationFacts facts, std::span<const physics::CurvePoint> points) {
  std::uint32_t checksum = 2166136261U;  // FNV-1a
  for (const physics::CurvePoint& point : points) {
    for (const char character : toml_number(point.gap.value) + " " + toml_number(point.volts.value) + "\n") {
      checksum = (checksum ^ static_cast<unsigned char>(character)) * 16777619U;
    }
  }
  std::string date = facts.origin.created_utc;
  std::erase_if(date, [](char character) { return character == '-' || character == ':'; });
  std::array<char, 16> digits{};
  std::snprintf(digits.data(), digits.size(), "%08x", checksum);
  facts.id = "sensor-" + date + "-" + digits.data();
  return facts;
}

std::string sensor_curve_text(const std::string& name, std::span<const physics::CurvePoint> points, const SensorCalibrationFacts& facts) {
  std::ostringstream out;
  out << "# A measured sensor curve: output voltage over the gap between sensor and plate, rising gaps.\n"
         "# Between the points: monotone cubic (Fritsch-Carlson). Use it in a rig file: [[sensor]] curve = \"this file\"\n"
         "# residual_mv: rms of the points about a smooth curve; repeat_mv: rms of repeated readings about their mean.\n";
  out << "name = " << toml_quoted(name) << "\n\n[calibration]\n";
  put_text(out, "id", facts.id);
  put_text(out, "created_utc", facts.origin.created_utc);
  put_text(out, "rig", facts.origin.rig);
  put_text(out, "sensor", facts.origin.sensor);
  put_text(out, "daq_model", facts.origin.daq_model);
  put_text(out, "daq_serial", facts.origin.daq_serial);
  put_text(out, "channel", facts.origin.channel);
  if (facts.range_v) out << "range_v = " << toml_number(*facts.range_v) << "\n";
  out << "residual_mv = " << toml_number(facts.residual_mv) << '\n';
  if (facts.repeat_mv) out << "repeat_mv = " << toml_number(*facts.repeat_mv) << '\n';
  out << "readings_per_gap = " << facts.readings_per_gap << "\nsamples_per_point = " << facts.samples_per_point << '\n';
  for (const physics::CurvePoint& point : points) {
    out << "\n[[point]]\ngap_mm = " << toml_number(point.gap.value) << "\nvolts = " << toml_number(point.volts.value) << '\n';
  }
  return std::move(out).str();
}

core::Status write_sensor_curve(const std::string& file, const std::string& name, std::span<const physics::CurvePoint> points,
                                const SensorCalibrationFacts& facts) {
  return write_whole_file(file, sensor_curve_text(name, points, facts));
}

}  // namespace dts::files
