// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/event.h"
#include "core/result.h"

namespace dts::pipeline {

enum class TriggerEdges : std::uint8_t { Rising, Falling, Both };

/// A channel with signals of another instrument (force plate, stimulator) or of our own sync output.
struct TriggerInput {
  std::size_t channel = 0;  ///< Device channel; must not be a sensor's.
  double level = 2.5;       ///< In the channel's unit, usually V.
  double hysteresis = 0.5;  ///< Width of a band around the level; a crossing is detected when the signal leaves the band on the other side.
  TriggerEdges edges = TriggerEdges::Rising;
};

/// Fails with InvalidArgument unless level and hysteresis are finite and the hysteresis is not negative.
[[nodiscard]] core::Status check(const TriggerInput& input);

/// Finds the scans at which a channel crosses a level. The event is at the first scan beyond the band, so it is exact to one scan (thesis
/// 4.6: plate and force plate were started by one analogue signal and aligned afterwards). The first scan of a segment only sets the
/// initial side: a crossing within a gap is unknown. Thread: rig. Realtime-safe: yes.
class EdgeDetector {
 public:
  EdgeDetector(const TriggerInput& input, core::Rate rate) noexcept : input_(input), rate_(rate) {}

  /// Searches column `column` of `block` and appends the events to `out`.
  void process(const core::Block& block, std::size_t column, core::TriggerEvents& out) noexcept;
  void reset() noexcept { side_ = Side::Unknown; }

  /// Number of values in the saved state, as in a stage.
  static constexpr std::size_t kStateSize = 1;
  void save(std::span<double> state) const noexcept;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept;

 private:
  enum class Side : std::uint8_t { Unknown, Low, High };
  [[nodiscard]] Side side_of(double volts) const noexcept;
  [[nodiscard]] bool is_wanted(bool is_rising) const noexcept;

  TriggerInput input_;
  core::Rate rate_;
  Side side_ = Side::Unknown;
};

}  // namespace dts::pipeline
