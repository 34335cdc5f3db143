// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "posturography/running_sway.h"

namespace dts::posturography {

/// Exact sums over the newest samples: in chunks, of which the oldest is dropped when there are too many.
///
///     [ chunk ][ chunk ] ... [ chunk ][ current ..      values: all of them, added up
///       oldest
///
/// Nothing is ever subtracted, so that no rounding error grows with time. Realtime-safe: yes, after the constructor.
class RecentSwaySums {
 public:
  /// Keeps at most `most_chunks` chunks, the current one included; at least one.
  explicit RecentSwaySums(double rate_hz = 0.0, std::size_t most_chunks = 1);

  void reset() noexcept;
  /// Adds the next sample; `index` is its place, for `first_index`.
  void add(double ml_mm, double ap_mm, std::uint64_t index) noexcept;
  /// Completes the current chunk, unless it is empty.
  void end_chunk() noexcept;

  [[nodiscard]] core::RunningSway values() const noexcept;
  /// Returns the index of the oldest sample in the values; 0 without a sample.
  [[nodiscard]] std::uint64_t first_index() const noexcept;

  [[nodiscard]] std::size_t state_size() const noexcept { return 1 + chunks_.size() * kChunkSize; }
  /// `state` has `state_size()` numbers; all are 0 without a sample.
  void save(std::span<double> state) const noexcept;
  /// Returns false if the numbers are impossible; the sums are then reset.
  [[nodiscard]] bool restore(std::span<const double> state) noexcept;

 private:
  static constexpr std::size_t kChunkSize = 3 + RunningSwaySums::kStateSize;  ///< In a state: first index, first sample, sums.
  struct Chunk {
    RunningSwaySums sums{};
    std::uint64_t first_index = 0;
    double first_ml_mm = 0.0;
    double first_ap_mm = 0.0;
  };

  std::vector<Chunk> chunks_;  ///< Oldest first; the first `count_` are in use, and the last of them is the current one.
  std::size_t count_ = 0;
  bool is_complete_ = false;  ///< The current chunk is complete: the next sample begins another one.
};

}  // namespace dts::posturography
