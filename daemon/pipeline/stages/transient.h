// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "pipeline/reach/spike_filter.h"
#include "pipeline/stage.h"

namespace dts::pipeline {

/// Computes the transient, the deflection of a chair's seat (thesis 5.3.3), from four sensors of the rig.
///
/// transient_mm  mean of the four (reach-model section 1: larger with more trunk flexion)
/// ratio         (front pair - rear pair) / mean: where the weight rests, independent of the weight
/// twist         ((rear left - rear right) - (front left - front right)) / mean: near 0 on a seat, large with swapped sensors
///
/// Replaces a channel that has a fault bit, or is unchanged for longer than its noise allows (section 5, channel guard): by its rest level
/// plus the change of its partner in the same row, or of the other row if the partner is bad too. Omitting the channel would cause a step
/// in the mean. A channel that was never good has its partner's value. Such scans have kSubstituted, and kUncalibrated if the channel was
/// at the end of its range. With fewer than two good channels, or without any rest level for a missing row, all values are NaN with the
/// fault bits.
///
/// On an empty seat, values stay finite with kNoContact. kUntared is passed on.
class Transient final : public Stage {
 public:
  static constexpr std::size_t kSensors = 4;  ///< Rear left, rear right, front left, front right.
  static constexpr double kEmptyMm = 0.8;     ///< Below this, the seat is empty (reach-model section 5).

  Transient(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] std::size_t state_size() const noexcept override;
  void save(std::span<double> state) const noexcept override;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override;

 private:
  struct Channel {
    SpikeFilter spikes;
    double last_mm = std::numeric_limits<double>::quiet_NaN();  ///< Unfiltered; NaN: equal to no value.
    std::uint64_t repeats = 0;
    double rest_mm = 0.0;  ///< Slow average while no channel that was ever good is bad.
    bool was_good = false;
  };
  using Values = std::array<double, kSensors>;
  using Goods = std::array<bool, kSensors>;

  /// Reads one scan: returns the good values, and the bits of the bad ones.
  std::uint8_t look(const core::Block& in, std::size_t scan, Values& values, Goods& goods) noexcept;
  bool is_believed(Channel& channel, double value_mm, std::uint8_t bits) const noexcept;
  void follow_rest(const Values& values, const Goods& goods) noexcept;
  /// Returns false if the values of the bad channels cannot be replaced.
  [[nodiscard]] bool substitute(Values& values, const Goods& goods) const noexcept;

  const physics::RigModel* rig_;
  double resolution_v_;
  double noise_mv_;
  std::array<std::size_t, kSensors> columns_{};
  std::array<Channel, kSensors> channels_{};
  std::uint64_t still_limit_ = 0;  ///< This many repeats mark a channel as bad; 0: no limit.
  double rest_gain_ = 0.0;
};

}  // namespace dts::pipeline
