// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "core/block.h"
#include "pipeline/stage_state.h"
#include "pipeline/tare.h"

namespace dts::pipeline {

/// Mean and scatter of each column over a fixed number of scans, for the decision on a tare. Does not run until `start`.
/// Thread: rig. Realtime-safe: yes.
class BaselineAverage {
 public:
  void start(std::uint64_t scans) noexcept;
  void stop() noexcept { remaining_ = 0; }
  [[nodiscard]] std::uint64_t remaining_scans() const noexcept { return remaining_; }

  /// Adds scans [first, first + scans) of `block`; at most `remaining_scans()`.
  void add(const core::Block& block, std::size_t first, std::size_t scans) noexcept;

  /// Judges the columns [first, end). Returns Done if no value had a fault bit, every mean is within `limit` of zero and every rms about
  /// its mean is within `noise`, both in the unit of the columns; otherwise the reason, with a sensor fault before all others. Valid when
  /// no scans remain.
  [[nodiscard]] TareOutcome outcome(std::size_t first, std::size_t end, double limit, double noise) const noexcept;
  [[nodiscard]] double mean(std::size_t channel) const noexcept;

  /// Returns the number of values that `save` writes and `restore` reads for so many columns. `scans`: the argument of `start`.
  [[nodiscard]] static constexpr std::size_t state_size(std::size_t channel_count) noexcept { return 1 + 4 * channel_count; }
  void save(StateWriter& writer, std::size_t channel_count) const noexcept;
  void restore(StateReader& reader, std::size_t channel_count, std::uint64_t scans) noexcept;

 private:
  /// Sums are of offsets from the first value: squares of the values themselves would lose a scatter of micrometres in rounding.
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
