// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "pipeline/stage.h"
#include "pipeline/stages/baseline_average.h"

namespace dts::pipeline {

/// Converts volts to deflection: unloaded gap - gap of the sensor's curve - baseline, in mm, positive downwards. Estimators need the
/// deflection: calibrated on raw volts, they have errors of 19-38 mm (plate-model section 5).
///
/// The baseline is 0 (and every value has kUntared) until a tare succeeds. A request through `Tare` starts a tare at the next block. With
/// `tare_at_start`, the first `tare_ms` of every segment also tare until one succeeds, so that a plate that is empty when the daemon starts
/// needs no command. The new baseline applies from the scan after the average. A rejected tare or a new segment changes nothing. With
/// `baseline` = nominal, the rig's unloaded gaps were measured on this very plate and are the baseline from the start; a requested tare
/// still replaces them.
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
  void handle_request() noexcept;
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
  std::uint64_t request_ = 0;  ///< The newest request; 0 during the automatic tare at the start.
  BaselineAverage average_;
  std::array<double, core::kMaxChannels> baseline_mm_{};
  bool is_tared_ = false;
};

}  // namespace dts::pipeline
