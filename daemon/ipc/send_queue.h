// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <string_view>

namespace dts::ipc {

/// Bytes that wait for a socket, in memory that is reserved before: `push` and `pop` never allocate.
///
///     [ popped | waiting | free ]     `push` moves the waiting bytes to the front if only the popped part makes room
class SendQueue {
 public:
  /// Reserves `capacity` bytes. The waiting bytes stay, and are always given room.
  void reserve(std::size_t capacity) {
    capacity = std::max(capacity, size());
    std::unique_ptr<char[]> bytes(new char[capacity]);
    if (size() > 0) std::memcpy(bytes.get(), bytes_.get() + begin_, size());
    bytes_ = std::move(bytes);
    end_ = size();
    begin_ = 0;
    capacity_ = capacity;
  }
  /// Appends all of `bytes`. Returns false, and appends nothing, if fewer than `spare` bytes would stay free. Realtime-safe: yes.
  [[nodiscard]] bool push(std::string_view bytes, std::size_t spare = 0) noexcept {
    if (size() + bytes.size() + spare > capacity_) return false;
    if (end_ + bytes.size() > capacity_) {
      std::memmove(bytes_.get(), bytes_.get() + begin_, size());
      end_ = size();
      begin_ = 0;
    }
    std::memcpy(bytes_.get() + end_, bytes.data(), bytes.size());
    end_ += bytes.size();
    return true;
  }
  /// Realtime-safe: yes.
  void pop(std::size_t count) noexcept {
    begin_ += count;
    if (begin_ == end_) begin_ = end_ = 0;
  }
  [[nodiscard]] std::string_view waiting() const noexcept { return {bytes_.get() + begin_, size()}; }
  [[nodiscard]] std::size_t size() const noexcept { return end_ - begin_; }
  [[nodiscard]] bool empty() const noexcept { return begin_ == end_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t capacity_ = 0;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace dts::ipc
