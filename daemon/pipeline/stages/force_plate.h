// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "pipeline/stage.h"
#include "pipeline/stages/baseline_average.h"
#include "pipeline/stages/zero_drift.h"

namespace dts::pipeline {

/// Computes the force and moment of a force plate from its channels: volts minus the zero of each channel, then the plate's matrix
/// (physics::ForcePlate). Output in the subject's frame: x to the right, y forward, z up; the reaction on the person, N; moments about the
/// centre of the top surface, N m. Load cells measure fz, mx and my only; the stream then has no other channels.
///
/// The zero is that of the rig file (and every value has kUntared) until a tare succeeds, as in `Linearise`. A tare is rejected as loaded
/// if the vertical force is farther than `tare_limit_n` from that of the rig file's zero. A fault bit or NaN on any channel makes the whole
/// scan NaN: nobody should trust a part of a plate that has a fault. Values under a person also have kUntared while the zero has probably
/// drifted by more than 1 % of the load since the tare (ZeroDrift).
class ForcePlate final : public Stage {
 public:
  ForcePlate(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] std::size_t state_size() const noexcept override;
  void save(std::span<double> state) const noexcept override;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override;

 private:
  using Volts = std::array<double, core::kMaxChannels>;
  [[nodiscard]] std::size_t channel_count() const noexcept { return plate_ == nullptr ? 0 : plate_->plate.channel_count(); }
  /// Returns the reaction on the person for volts above `zero_v`.
  [[nodiscard]] physics::Wrench wrench(const Volts& volts, const Volts& zero_v) const noexcept;
  void forget() noexcept;
  void handle_request() noexcept;
  void average(const core::Block& in, std::size_t scans) noexcept;
  void finish_average() noexcept;
  [[nodiscard]] bool has_possible_means() const noexcept;
  void compute(const core::Block& in, core::Block& out, std::size_t first, std::size_t scans) noexcept;
  void report(TareOutcome outcome) noexcept;

  const physics::ForcePlateModel* plate_;  ///< nullptr: the rig is not a force plate; `prepare` fails.
  Tare* tare_;
  double tare_ms_;
  double tare_limit_n_;
  double tare_noise_n_;
  bool tares_at_start_;
  double drift_ms_;

  Volts file_zero_v_{};
  std::uint64_t tare_scans_ = 1;
  std::uint64_t request_ = 0;  ///< The newest request; 0 during the automatic tare at the start.
  BaselineAverage average_;
  core::Block averaged_;  ///< Input of the average: the channels, then the vertical force above the rig file's zero.
  Volts zero_v_{};
  bool is_tared_ = false;
  ZeroDrift drift_;
  TareOutcome outcome_ = TareOutcome::None;  ///< As reported last.
};

}  // namespace dts::pipeline
