// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/block.h"
#include "physics/force_plate/wrench.h"

namespace dts::pipeline {

/// Returns the channels of the stream "force": fx_n fy_n fz_n (N), mx_nm my_nm mz_nm (N m); without shear only fz_n, mx_nm, my_nm.
[[nodiscard]] std::vector<core::ChannelFormat> force_channels(bool has_shear);

/// The columns of a block of the stream "force". Thread: rig. Realtime-safe: yes.
class ForceStream {
 public:
  /// The block has the channels of `force_channels`.
  explicit ForceStream(const core::Block& block) noexcept;

  /// Writes scan `scan`; every channel gets the same `bits`.
  void put(const physics::Wrench& wrench, std::uint8_t bits, core::Block& block, std::size_t scan) const noexcept;
  /// Returns scan `scan`; what the stream does not have is 0.
  [[nodiscard]] physics::Wrench get(const core::Block& block, std::size_t scan) const noexcept;

 private:
  bool has_shear_;
};

}  // namespace dts::pipeline
