// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "pipeline/stage.h"
#include "pipeline/stages/baseline_average.h"

namespace dts::pipeline {

/// Volts to deflection: unloaded gap - gap of the sensor's curve - baseline, in mm, downwards positive. Estimators need this and not
/// volts: calibrated on raw volts they err by 19-38 mm (plate-model section 5).
///
/// The baseline is 0 (and every value kUntared) until a tare is done: on a request in the `Tare` letter box, taken up at the
/// next block, and with `tare_at_start` by itself over the first `tare_ms` of every segment until one succeeds, so that a
/// plate that is empty when the daemon starts needs no command. The baseline counts from the scan after the average;
/// a refused tare changes nothing, and neither does a new segment. With `baseline` nominal the rig's unloaded gaps were measured on this
/// very plate and are the baseline from the start; a commanded tare still replaces them.
class Linearise final : public Stage {
 public:
  Linearise(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] std::size_t state_size() const noexcept override;
  void save(std::span<double> state) const noexcept override;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override;

 private:
  void forget() noexcept;
  void take_request() noexcept;
  void finish_average() noexcept;
  void subtract_baseline(core::Block& out, std::size_t first, std::size_t scans) const noexcept;
  void report(TareOutcome outcome) noexcept;

  const physics::RigModel* rig_;
  Tare* tare_;
  double tare_ms_;
  double tare_limit_mm_;
  double tare_noise_mm_;
  bool tares_at_start_;
  bool is_nominal_;  ///< The rig's unloaded gaps count as a tare.

  std::uint64_t tare_scans_ = 1;
  std::uint64_t request_ = 0;  ///< The newest one taken up; 0 while the start's own tare runs.
  BaselineAverage average_;
  std::array<double, core::kMaxChannels> baseline_mm_{};
  bool is_tared_ = false;
};

}  // namespace dts::pipeline
