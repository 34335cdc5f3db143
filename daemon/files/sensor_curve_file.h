// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "core/result.h"
#include "files/toml_reader.h"
#include "physics/sensor_calibration.h"
#include "physics/sensor_curve.h"

namespace dts::files {

/// How a sensor's curve was measured.
struct SensorCalibrationFacts {
  std::string id;  ///< "sensor-20260131T120000Z-1a2b3c4d": date and a checksum of the points.
  physics::SensorCurveOrigin origin;
  std::optional<double> range_v;      ///< Range of the channel: +-range_v around 0 V.
  double residual_mv = 0.0;           ///< RMS distance of the points from a smooth curve.
  std::optional<double> repeat_mv;    ///< RMS distance of repeated readings from their mean.
  std::size_t readings_per_gap = 1;   ///< Number of readings at the gap with the fewest.
  std::size_t samples_per_point = 1;  ///< Scans averaged for one reading.
};

struct SensorCurveFile {
  physics::SensorCurve curve;
  std::optional<SensorCalibrationFacts> calibration;  ///< Absent in files written by hand.
};

/// Reads `name`, [calibration] if present, and the points: at least two, with strictly rising gaps and strictly monotone volts. If
/// something is wrong, adds it to `problems` and returns nothing.
[[nodiscard]] std::optional<SensorCurveFile> read_sensor_curve(const std::string& file, Problems& problems);

/// Reads the same from a parsed table: of a file, or inside a rig definition.
[[nodiscard]] std::optional<SensorCurveFile> read_sensor_curve(TomlReader& reader, Problems& problems);

/// Returns `facts` with `id` set from its date and the points.
[[nodiscard]] SensorCalibrationFacts with_id(SensorCalibrationFacts facts, std::span<const physics::CurvePoint> points);

/// Returns the file as TOML. Every number reads back as exactly the same double.
[[nodiscard]] std::string sensor_curve_text(const std::string& name, std::span<const physics::CurvePoint> points,
                                            const SensorCalibrationFacts& facts);
/// Writes `file` completely or not at all, see `write_whole_file`.
[[nodiscard]] core::Status write_sensor_curve(const std::string& file, const std::string& name, std::span<const physics::CurvePoint> points,
                                              const SensorCalibrationFacts& facts);

}  // namespace dts::files
