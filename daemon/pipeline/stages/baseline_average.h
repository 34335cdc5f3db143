// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "core/block.h"
#include "pipeline/stage_state.h"
#include "pipeline/tare.h"

namespace dts::pipeline {

/// Mean and scatter of each column over a fixed number of scans: what a tare decides on. Not running until `start`.
/// Thread: pipeline. Realtime-safe: yes.
class BaselineAverage {
 public:
  void start(std::uint64_t scans) noexcept;
  void stop() noexcept { remaining_ = 0; }
  [[nodiscard]] std::uint64_t remaining_scans() const noexcept { return remaining_; }

  /// Takes scans [first, first + scans) of `block`; at most `remaining_scans()`.
  void add(const core::Block& block, std::size_t first, std::size_t scans) noexcept;

  /// Done when no value had a fault bit, every mean lies within `limit_mm` of zero and every rms about its mean within
  /// `noise_mm`; else the reason, the sensor's first. Meaningful when nothing remains.
  [[nodiscard]] TareOutcome judge(std::size_t channel_count, double limit_mm, double noise_mm) const noexcept;
  [[nodiscard]] double mean(std::size_t channel) const noexcept;

  /// Numbers that `save` writes for so many columns, and `restore` takes. `scans`: what `start` was given, or would be.
  [[nodiscard]] static constexpr std::size_t state_size(std::size_t channel_count) noexcept { return 1 + 4 * channel_count; }
  void save(StateWriter& writer, std::size_t channel_count) const noexcept;
  void restore(StateReader& reader, std::size_t channel_count, std::uint64_t scans) noexcept;

 private:
  /// Sums are kept around the first value: squares of the values themselves would lose a scatter of micrometres.
  struct Sums {
    double origin = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    std::uint8_t bits = 0;
  };

  std::uint64_t scans_ = 0;
  std::uint64_t remaining_ = 0;
  std::array<Sums, core::kMaxChannels> sums_{};
};

}  // namespace dts::pipeline
