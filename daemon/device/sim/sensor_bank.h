// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "device/sim/floor_options.h"
#include "physics/rig_model.h"

namespace dts::device::sim {

/// The true load on the plate; no load by default.
struct Truth {
  double ml_mm = std::numeric_limits<double>::quiet_NaN();  ///< Position of the load from the plate's centre; NaN: no load.
  double ap_mm = std::numeric_limits<double>::quiet_NaN();
  double load_n = 0.0;
};

/// The mounted sensors of a rig, each with its own gain and unloaded gap. Writes all channels of the device: sensors, extra
/// channels, then true_ml_mm, true_ap_mm, true_load_n if enabled.
/// Const methods: Thread: any. Realtime-safe: yes.
class SensorBank {
 public:
  /// `rig` must outlive the bank.
  SensorBank(const FloorOptions& options, const physics::RigModel& rig);

  /// Writes all channels; the gap of every sensor is its unloaded gap minus its deflection.
  void write_deflected(std::span<const double> deflection_mm, const Truth& truth, std::span<double> values) const noexcept;
  /// Writes all channels; the gap of every sensor is `part` of the way from the far end of its curve to `gap_mm`.
  void write_gap(double gap_mm, double part, std::span<double> values) const noexcept;

 private:
  struct Sensor {
    const physics::SensorCurve* curve = nullptr;
    double unloaded_gap_mm = 0.0;
    double gain = 1.0;

    [[nodiscard]] double volts(double gap_mm) const noexcept { return gain * curve->volts(core::Millimetres{gap_mm}).value; }
  };
  void write_rest(const Truth& truth, std::span<double> values) const noexcept;

  std::vector<Sensor> sensors_;
  std::size_t extra_;
  bool has_truth_;
};

}  // namespace dts::device::sim
