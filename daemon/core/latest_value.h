// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace dts::core {

/// Passes the newest value from one writer thread to one reader thread, wait-free on both sides; overwrites older values.
///
/// Three buffers: one belongs to the writer, one to the reader, one is in the middle. `store` fills the writer's buffer and
/// swaps it with the middle buffer; `load` swaps the reader's buffer with the middle buffer if that is fresh:
///
///     writer [a] <--swap--> middle [b] + fresh bit <--swap--> reader [c]
///
/// Unlike with a sequence lock, no side ever reads a buffer that the other side may write. The model checker replaces `Atomic`.
template <class T, template <class> class Atomic = std::atomic>
class LatestValue {
 public:
  explicit LatestValue(const T& initial = T{}) : buffers_{initial, initial, initial} {}
  LatestValue(const LatestValue&) = delete;
  LatestValue& operator=(const LatestValue&) = delete;

  /// Thread: the writer. Realtime-safe: yes when copying T is.
  void store(const T& value) noexcept {
    buffers_[write_index_] = value;
    // Release publishes the written buffer; acquire makes sure that the reader no longer uses the received buffer. Pairs with load().
    write_index_ = middle_.exchange(write_index_ | kFresh, std::memory_order_acq_rel) & kIndexMask;
  }

  /// Returns the newest stored value. The reference is valid until the next load(). Thread: the reader. Realtime-safe: yes.
  [[nodiscard]] const T& load() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      // Acquire makes the writer's buffer visible; release returns the reader's buffer to the writer. Pairs with store().
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
