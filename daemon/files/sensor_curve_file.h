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

/// How a sensor's curve was measured. Empty texts are unknown.
struct SensorCalibrationFacts {
  std::string id;           ///< "sensor-20260131T120000Z-1a2b3c4d": date and a checksum of the points.
  std::string created_utc;  ///< ISO 8601: "2026-01-31T12:00:00Z"
  std::string rig;
  std::string sensor;  ///< Its label in the rig.
  std::string daq_model;
  std::string daq_serial;
  std::string channel;                ///< Of the DAQ.
  std::optional<double> range_v;      ///< Of the channel, both sides of 0 V.
  double residual_mv = 0.0;           ///< Of the points about a smooth curve, rms.
  std::optional<double> repeat_mv;    ///< Of repeated readings about their mean, rms.
  std::size_t readings_per_gap = 1;   ///< The least of any gap.
  std::size_t samples_per_point = 1;  ///< Scans averaged to a reading.
};

struct SensorCurveFile {
  physics::SensorCurve curve;
  std::optional<SensorCalibrationFacts> calibration;  ///< Absent in files written by hand.
};

/// Reads `name`, [calibration] if there is one, and the points, at least two of strictly rising gap and strictly monotone volts.
/// What is wrong is added to `problems` and nothing is returned.
[[nodiscard]] std::optional<SensorCurveFile> read_sensor_curve(const std::string& file, Problems& problems);

/// The same of a table that was parsed already: a file's, or one inside a rig definition.
[[nodiscard]] std::optional<SensorCurveFile> read_sensor_curve(TomlReader& reader, Problems& problems);

/// `facts` with `id` made from its date and the points.
[[nodiscard]] SensorCalibrationFacts with_id(SensorCalibrationFacts facts, std::span<const physics::CurvePoint> points);

/// The file as TOML; every number reads back as exactly the same double.
[[nodiscard]] std::string sensor_curve_text(const std::string& name, std::span<const physics::CurvePoint> points,
                                            const SensorCalibrationFacts& facts);
/// Whole or not at all, see `write_whole_file`.
[[nodiscard]] core::Status write_sensor_curve(const std::string& file, const std::string& name, std::span<const physics::CurvePoint> points,
                                              const SensorCalibrationFacts& facts);

}  // namespace dts::files
