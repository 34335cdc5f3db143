// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace dts::core {

/// Lock-free ring for one producer thread and one consumer thread. Slots are built once and reused: only the constructor
/// allocates. The producer never pops; when the ring is full, the *new* element is dropped and counted.
///
/// Indices only increase and are masked on access, so full (head - tail == capacity) differs from empty (head == tail):
///
///     slot      0   1   2   3   4   5   6   7         capacity 8
///                       [tail = 10 ... head = 14)     4 readable, 4 writable
///
/// Each side keeps a private copy of the other side's index and reads the shared index only if the copy shows full or empty: in
/// steady state a batch costs one cache-line transfer. The model checker replaces `Atomic`.
template <class T, template <class> class Atomic = std::atomic>
class SpscRing {
 public:
  /// Makes at least `minimum_capacity` slots (rounded up to a power of two), each a copy of `prototype`. The caller must check the
  /// capacity, because it decides how much memory is allocated. Thread: control.
  explicit SpscRing(std::size_t minimum_capacity, const T& prototype = T{})
      : slots_(std::bit_ceil(std::max<std::size_t>(minimum_capacity, 1)), prototype), mask_(slots_.size() - 1) {}
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  [[nodiscard]] std::size_t capacity() const noexcept { return mask_ + 1; }

  /// Returns the slot to fill next, in place, or nullptr when full (then call `drop()`). The slot still has its old content; another
  /// `claim()` without `commit()` returns the same slot. Thread: producer. Realtime-safe: yes.
  [[nodiscard]] T* claim() noexcept;
  /// Passes the claimed slot to the consumer. Only after `claim()` returned a slot. Thread: producer. Realtime-safe: yes.
  void commit() noexcept;
  /// Counts `elements` dropped elements. Thread: producer. Realtime-safe: yes.
  void drop(std::uint64_t elements = 1) noexcept;
  /// Copies `element` into the ring and returns true; if the ring is full, drops and counts it and returns false.
  /// Thread: producer. Realtime-safe: yes when copying T is.
  bool push(const T& element) noexcept;
  /// Copies as many of `elements` as fit, drops and counts the rest; returns how many were copied.
  /// Thread: producer. Realtime-safe: yes when copying T is.
  std::size_t push(std::span<const T> elements) noexcept;

  /// Returns the oldest element, in place, or nullptr when empty. Thread: consumer. Realtime-safe: yes.
  [[nodiscard]] T* front() noexcept;
  /// Returns the slot of `front()` to the producer. Only after `front()` returned an element. Thread: consumer. Realtime-safe: yes.
  void release() noexcept;
  /// Copies the oldest element to `out` and removes it; returns false when empty. Thread: consumer. Realtime-safe: yes when copying T is.
  bool pop(T& out) noexcept;
  /// Copies up to `out.size()` elements to `out` and removes them; returns how many.
  /// Thread: consumer. Realtime-safe: yes when copying T is.
  std::size_t pop(std::span<T> out) noexcept;

  /// Returns the number of waiting elements; in any thread but producer and consumer, an estimate. Thread: any. Realtime-safe: yes.
  [[nodiscard]] std::size_t waiting() const noexcept {
    const std::uint64_t tail =
        tail_.load(std::memory_order_acquire);  // pairs with release() and pop(): `head_`, loaded next, is not below this tail
    return static_cast<std::size_t>(std::min<std::uint64_t>(head_.load(std::memory_order_relaxed) - tail, capacity()));
  }
  /// Returns the number of dropped elements since construction. Thread: any. Realtime-safe: yes.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kCacheLine = 64;
  static constexpr bool kCopies = std::is_nothrow_copy_assignable_v<T>;  ///< false: only the in-place calls compile.

  std::vector<T> slots_;
  std::size_t mask_;

  alignas(kCacheLine) Atomic<std::uint64_t> head_{0};  ///< Number of pushed elements; written by the producer.
  std::uint64_t cached_tail_ = 0;                      ///< Producer's copy of `tail_`.
  Atomic<std::uint64_t> dropped_{0};

  alignas(kCacheLine) Atomic<std::uint64_t> tail_{0};  ///< Number of popped elements; written by the consumer.
  std::uint64_t cached_head_ = 0;                      ///< Consumer's copy of `head_`.
};

template <class T, template <class> class Atomic>
T* SpscRing<T, Atomic>::claim() noexcept {
  const std::uint64_t head = head_.load(std::memory_order_relaxed);  // own index
  if (head - cached_tail_ == capacity()) {
    cached_tail_ = tail_.load(std::memory_order_acquire);  // pairs with release(): the consumer no longer uses the slot
    if (head - cached_tail_ == capacity()) return nullptr;
  }
  return &slots_[head & mask_];
}

template <class T, template <class> class Atomic>
void SpscRing<T, Atomic>::commit() noexcept {
  head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release);  // pairs with front()
}

template <class T, template <class> class Atomic>
void SpscRing<T, Atomic>::drop(std::uint64_t elements) noexcept {
  dropped_.store(dropped_.load(std::memory_order_relaxed) + elements, std::memory_order_relaxed);  // one writer
}

template <class T, template <class> class Atomic>
bool SpscRing<T, Atomic>::push(const T& element) noexcept {
  static_assert(kCopies, "copying this type may allocate or throw: fill the slot in place, see claim()");
  T* const slot = claim();
  if (slot == nullptr) {
    drop();
    return false;
  }
  *slot = element;
  commit();
  return true;
}

template <class T, template <class> class Atomic>
std::size_t SpscRing<T, Atomic>::push(std::span<const T> elements) noexcept {
  static_assert(kCopies, "copying this type may allocate or throw: fill the slot in place, see claim()");
  const std::uint64_t head = head_.load(std::memory_order_relaxed);  // own index
  std::uint64_t room = capacity() - (head - cached_tail_);
  if (room < elements.size()) {
    cached_tail_ = tail_.load(std::memory_order_acquire);  // pairs with release() and pop()
    room = capacity() - (head - cached_tail_);
  }
  const std::size_t taken = std::min<std::size_t>(elements.size(), room);
  const std::size_t start = head & mask_;
  const std::size_t until_wrap = std::min(taken, capacity() - start);
  std::copy_n(elements.begin(), until_wrap, slots_.begin() + static_cast<std::ptrdiff_t>(start));
  if (until_wrap < taken) [[unlikely]] {
    std::copy_n(elements.begin() + static_cast<std::ptrdiff_t>(until_wrap), taken - until_wrap, slots_.begin());
  }
  if (taken > 0) head_.store(head + taken, std::memory_order_release);  // pairs with pop() and front()
  if (taken < elements.size()) drop(elements.size() - taken);
  return taken;
}

template <class T, template <class> class Atomic>
T* SpscRing<T, Atomic>::front() noexcept {
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);  // own index
  if (tail == cached_head_) {
    cached_head_ = head_.load(std::memory_order_acquire);  // pairs with commit() and push(): the slot is written
    if (tail == cached_head_) return nullptr;
  }
  return &slots_[tail & mask_];
}

template <class T, template <class> class Atomic>
void SpscRing<T, Atomic>::release() noexcept {
  tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release);  // pairs with claim() and push()
}

template <class T, template <class> class Atomic>
bool SpscRing<T, Atomic>::pop(T& out) noexcept {
  static_assert(kCopies, "copying this type may allocate or throw: read the slot in place, see front()");
  const T* const slot = front();
  if (slot == nullptr) return false;
  out = *slot;
  release();
  return true;
}

template <class T, template <class> class Atomic>
std::size_t SpscRing<T, Atomic>::pop(std::span<T> out) noexcept {
  static_assert(kCopies, "copying this type may allocate or throw: read the slot in place, see front()");
  const std::uint64_t tail = tail_.load(std::memory_order_relaxed);                            // own index
  if (cached_head_ - tail < out.size()) cached_head_ = head_.load(std::memory_order_acquire);  // pairs with commit() and push()
  const std::size_t taken = std::min<std::size_t>(out.size(), cached_head_ - tail);
  const std::size_t start = tail & mask_;
  const std::size_t until_wrap = std::min(taken, capacity() - start);
  std::copy_n(slots_.begin() + static_cast<std::ptrdiff_t>(start), until_wrap, out.begin());
  if (until_wrap < taken) [[unlikely]] {
    std::copy_n(slots_.begin(), taken - until_wrap, out.begin() + static_cast<std::ptrdiff_t>(until_wrap));
  }
  if (taken > 0) tail_.store(tail + taken, std::memory_order_release);  // pairs with claim() and push()
  return taken;
}

}  // namespace dts::core
