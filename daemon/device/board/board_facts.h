// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "device/board/frames.h"

namespace dts::device::board {

/// What a board says about itself: its DESCRIPTOR and all of its CHANNELs. Realtime-safe: yes.
class BoardFacts {
 public:
  /// What a frame has changed.
  enum class Change : std::uint8_t {
    None,     ///< It says the same again.
    Learned,  ///< A new fact that contradicts nothing.
    Another,  ///< It contradicts an earlier frame: another board, or a new configuration. The earlier facts are forgotten.
  };
  Change add(const Descriptor& descriptor) noexcept;
  /// Fails if another channel has this name.
  [[nodiscard]] Parsed<Change> add(const Channel& channel) noexcept;
  void forget() noexcept { *this = {}; }
  /// The complete facts agree with the address. This ends with every frame that contradicts them.
  void agree() noexcept { is_agreed_ = true; }
  /// The board has described itself in a way that was rejected.
  void doubt() noexcept { is_agreed_ = false; }
  [[nodiscard]] bool is_agreed() const noexcept { return is_agreed_; }

  [[nodiscard]] bool has_descriptor() const noexcept { return descriptor_.has_value(); }
  /// Needs `has_descriptor`.
  [[nodiscard]] const Descriptor& descriptor() const noexcept { return *descriptor_; }
  /// Returns true if the DESCRIPTOR and every CHANNEL are known.
  [[nodiscard]] bool is_complete() const noexcept;
  /// Needs `is_complete`.
  [[nodiscard]] std::span<const Channel> channels() const noexcept { return {channels_.data(), descriptor_->channels}; }

 private:
  std::optional<Descriptor> descriptor_;
  std::array<Channel, core::kMaxChannels> channels_{};
  std::array<bool, core::kMaxChannels> is_known_{};
  bool is_agreed_ = false;
};

}  // namespace dts::device::board
