// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "pipeline/reach/spike_filter.h"
#include "pipeline/stage.h"

namespace dts::pipeline {

/// How far the seat of a chair bends: the thesis's transient (5.3.3), from the four sensors that the rig uses for it.
///
/// transient_mm  mean of the four (reach-model section 1: bigger with more trunk flexion)
/// ratio         (front pair - rear pair) / mean: where the weight rests, without the weight
/// twist         ((rear left - rear right) - (front left - front right)) / mean: near 0 on a seat, far from it with swapped sensors
///
/// A channel with a fault bit, or standing still for longer than its noise allows, is replaced (section 5, channel guard): by where it was
/// at rest plus the change of its partner on the other side of the same row, or of the other row when that is bad as well. Dropping it
/// would step the mean. One that was never good follows its partner. Such scans have kSubstituted, and kUncalibrated when the channel was
/// at the end of its range. With fewer than two good channels, or without any idea of a missing row, everything is NaN with the fault bits.
///
/// On an empty seat values stay finite with kNoContact. kUntared passes through.
class Transient final : public Stage {
 public:
  static constexpr std::size_t kSensors = 4;  ///< Rear left, rear right, front left, front right.
  static constexpr double kEmptyMm = 0.8;     ///< Below nobody sits there (reach-model section 5).

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
    double last_mm = std::numeric_limits<double>::quiet_NaN();  ///< As it came; NaN: unlike anything.
    std::uint64_t repeats = 0;
    double rest_mm = 0.0;  ///< Slow average while all channels that ever were good are good.
    bool was_good = false;
  };
  using Values = std::array<double, kSensors>;
  using Goods = std::array<bool, kSensors>;

  /// Takes in one scan: what is good, and the bits of what is not.
  std::uint8_t look(const core::Block& in, std::size_t scan, Values& values, Goods& goods) noexcept;
  bool is_believed(Channel& channel, double value_mm, std::uint8_t bits) const noexcept;
  void follow_rest(const Values& values, const Goods& goods) noexcept;
  /// False when there is no way to tell what the bad channels would say.
  [[nodiscard]] bool substitute(Values& values, const Goods& goods) const noexcept;

  const physics::RigModel* rig_;
  double resolution_v_;
  double noise_mv_;
  std::array<std::size_t, kSensors> columns_{};
  std::array<Channel, kSensors> channels_{};
  std::uint64_t still_limit_ = 0;  ///< Repeats that are still believed; 0: any number.
  double rest_gain_ = 0.0;
};

}  // namespace dts::pipeline
