// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/rate.h"
#include "pipeline/stage.h"

namespace dts::pipeline {

/// Moving average of the last `window` scans (thesis 4.5: window 3, shift 1). No output until the window is full. With a shift of n, only
/// scans whose index is a multiple of n are output, as scan index / n at rate / n.
///
/// The stream is divided into chunks as long as the window. A window is then the end of one chunk and the beginning of the next:
///
///     scans      | a b c d e | f g h i j |        window 5, now at h: mean of d e f g h
///     slots        f g h . .                      1. the new scans overwrite the previous chunk
///                  . . . S S                      2. the other slots hold sums to the chunk's end: d+e, e
///     head = f+g+h,  window = head + slot[3]      3. at j the slots become sums to the end: f+..+j, ..., j
///
/// No value is ever subtracted, so rounding errors do not accumulate, a NaN disappears when it leaves the window, and the cost per scan
/// does not depend on the window. Chunks start at the beginning of the segment, independent of blocks. Quality bits are combined in the
/// same way, with OR in place of the sum. (M. van Herk's scheme for running maxima, Pattern Recognition Letters 13, 1992.)
class WindowFilter final : public Stage {
 public:
  WindowFilter(const StageOptions& options, const StageContext& context);

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
    std::vector<double> sums;        ///< The slots of the diagram, and a last one that is always 0.
    std::vector<std::uint8_t> bits;  ///< The same for the quality bits.
    double head_sum = 0.0;
    std::uint8_t head_bits = 0;
  };
  void filter_channel(Channel& channel, std::span<const double> in, std::span<const std::uint8_t> in_bits, std::size_t first_kept,
                      std::span<double> out, std::span<std::uint8_t> out_bits) const noexcept;
  void fold(Channel& channel) const noexcept;

  std::size_t window_scans_;
  double window_ms_;
  std::size_t shift_scans_;
  core::Rate rate_;
  std::vector<Channel> channels_;
  std::size_t slot_ = 0;          ///< Slot of the next scan, in [0, window).
  std::uint64_t seen_scans_ = 0;  ///< Since the beginning of the segment.
};

}  // namespace dts::pipeline
