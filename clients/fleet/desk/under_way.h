// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>

namespace dts::fleet::desk {

/// Counts messages and their bytes on the way from one thread to another, and rejects what exceeds a limit. Thread: `add` from one,
/// `remove` from any.
class UnderWay {
 public:
  static constexpr std::size_t kMostMessages = 2048;
  static constexpr std::size_t kMostBytes = std::size_t{8} << 20U;

  /// Returns false, and counts nothing, if there are too many.
  [[nodiscard]] bool add(std::size_t bytes) noexcept {
    if (messages_.load(std::memory_order_relaxed) >= kMostMessages) return false;
    if (bytes > kMostBytes - bytes_.load(std::memory_order_relaxed)) return false;
    messages_.fetch_add(1, std::memory_order_relaxed);
    bytes_.fetch_add(bytes, std::memory_order_relaxed);
    return true;
  }
  void remove(std::size_t bytes) noexcept {
    messages_.fetch_sub(1, std::memory_order_relaxed);
    bytes_.fetch_sub(bytes, std::memory_order_relaxed);
  }

 private:
  std::atomic<std::size_t> messages_ = 0;
  std::atomic<std::size_t> bytes_ = 0;
};

}  // namespace dts::fleet::desk
