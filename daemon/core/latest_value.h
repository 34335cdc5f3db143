// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace dts::core {

/// The newest value from one writer thread to one reader thread, wait-free on both sides; older values are overwritten.
///
/// Three buffers: one belongs to the writer, one to the reader, one lies in the middle. `store` fills its own buffer and
/// swaps it with the middle one; `load` swaps its own with the middle one when that is fresh:
///
///     writer [a] <--swap--> middle [b] + fresh bit <--swap--> reader [c]
///
/// Unlike a sequence lock, no side ever reads a buffer that the other may write. `Atomic` is replaced by the model checker.
template <class T, template <class> class Atomic = std::atomic>
class LatestValue {
 public:
  explicit LatestValue(const T& initial = T{}) : buffers_{initial, initial, initial} {}
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// Thread: the writer. Realtime-safe: yes when copying T is.
  void store(const T& value) noexcept {
    buffers_[write_index_] = value;
    // Release publishes the buffer just written; acquire takes over the one the reader gave back. Pairs with load().
    write_index_ = middle_.exchange(write_index_ | kFresh, std::memory_order_acq_rel) & kIndexMask;
  }

  /// The newest stored value. The reference is valid until the next load(). Thread: the reader. Realtime-safe: yes.
  [[nodiscard]] const T& load() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      // Acquire sees the writer's buffer; release gives ours back for writing. Pairs with store().
      read_index_ = middle_.exchange(read_index_, std::memory_order_acq_rel) & kIndexMask;
    }
    return buffers_[read_index_];
  }

 private:
  static constexpr std::uint32_t kIndexMask = 3;
  static constexpr std::uint32_t kFresh = 4;

  std::array<T, 3> buffers_;
  std::uint32_t write_index_ = 0;
  Atomic<std::uint32_t> middle_{1};
  std::uint32_t read_index_ = 2;
};

}  // namespace dts::core
