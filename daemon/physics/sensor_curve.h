// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "core/units.h"

namespace dts::physics {

struct CurvePoint {
  core::Millimetres gap;
  core::Volts volts;
};

/// With what a curve was measured. An empty text means "not known".
struct SensorCurveOrigin {
  std::string created_utc;  ///< ISO 8601: "2026-01-31T12:00:00Z"
  std::string rig;
  std::string sensor;  ///< Its label in the rig.
  std::string daq_model;
  std::string daq_serial;
  std::string channel;  ///< Of the DAQ.
};

/// Output voltage of a reflective sensor as a function of its gap: strictly monotone, interpolated between calibration points by monotone
/// cubic Hermite (Fritsch-Carlson), which cannot overshoot.
///
/// Both directions use dense tables built at creation, linear between entries. Gap to volts and back returns the gap within 1e-4 mm. NaN in
/// gives NaN out. Thread: any. Realtime-safe: yes.
class SensorCurve {
 public:
  /// Needs at least two points with strictly rising gap and strictly monotone volts (rising or falling); else fails with InvalidArgument
  /// and names the point. Also fails if the curve is so flat somewhere that the tables cannot be inverted within 1e-4 mm.
  [[nodiscard]] static core::Result<SensorCurve> create(std::string name, std::vector<CurvePoint> points);
  /// The curve assumed in plate-model section 5 for the HOA1405-2 (thesis Fig. 3.9 is missing): V = 0.9 + 0.35 z + 0.058 z^2,
  /// z = 12 mm - gap, as points every 0.25 mm over 4..13 mm.
  [[nodiscard]] static SensorCurve hoa1405_assumed();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] core::Millimetres minimum_gap() const noexcept;
  [[nodiscard]] core::Millimetres maximum_gap() const noexcept;

  /// A gap outside the calibrated range counts as the end of the range.
  [[nodiscard]] core::Volts volts(core::Millimetres gap) const noexcept;
  /// A voltage outside the calibrated range counts as the end of the range; check with `contains`.
  [[nodiscard]] core::Millimetres gap(core::Volts volts) const noexcept;
  [[nodiscard]] bool contains(core::Volts volts) const noexcept;

 private:
  SensorCurve() = default;
  [[nodiscard]] double round_trip_error_mm() const noexcept;

  std::string name_;
  std::vector<CurvePoint> points_;
  double lowest_v_ = 0.0;
  double highest_v_ = 0.0;
  std::vector<double> volts_table_;  ///< Even steps of gap.
  std::vector<double> gap_table_;    ///< Even steps of volts.
};

}  // namespace dts::physics
