// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace dts::core {

/// Lock-free ring for one writer thread and any number of reader threads. The writer knows no reader and never waits: it overwrites the
/// oldest element. A reader counts for itself, copies an element out, and learns whether it was overwritten meanwhile.
///
///     element     10  11  12          capacity 3, written() = 13
///     slot         1   2   0          element 13 will overwrite element 10
///
/// An element is a number of 64-bit words, at most `slot_words`. Only the constructor allocates.
///
/// `begun_` is stored before the first word of an element and `written_` after the last. Each word is stored with release order: a reader
/// that has loaded a word of a later element therefore also finds that element begun, and rejects its copy. After that, `written` returns a
/// newer number, so that the reader can skip. The model checker replaces `Atomic`.
template <template <class> class Atomic = std::atomic>
class BroadcastRing {
 public:
  using Word = std::uint64_t;

  /// Makes `slots` slots, at least one. The caller must check both sizes, because they decide how much memory is allocated. Thread: control.
  BroadcastRing(std::size_t slots, std::size_t slot_words)
      : slot_words_(slot_words),
        slots_(std::max<std::size_t>(slots, 1)),
        words_(std::make_unique<Atomic<Word>[]>(slots_ * stride())) {}

  [[nodiscard]] std::size_t capacity() const noexcept { return slots_; }
  [[nodiscard]] std::size_t slot_words() const noexcept { return slot_words_; }

  /// Writes an element; ignores words beyond `slot_words`. Thread: the writer. Realtime-safe: yes.
  void write(std::span<const Word> element) noexcept {
    const std::uint64_t index = written_.load(std::memory_order_relaxed);  // own index
    begun_.store(index + 1, std::memory_order_release);                    // pairs with read()
    Atomic<Word>* const slot = slot_of(index);
    const std::size_t size = std::min(element.size(), slot_words_);
    slot[0].store(size, std::memory_order_release);  // as below: pairs with read()
    for (std::size_t word = 0; word < size; ++word) slot[word + 1].store(element[word], std::memory_order_release);
    written_.store(index + 1, std::memory_order_release);  // pairs with written()
  }

  /// Returns how many elements have been written since the construction. Thread: any. Realtime-safe: yes.
  [[nodiscard]] std::uint64_t written() const noexcept { return written_.load(std::memory_order_acquire); }  // pairs with write()

  /// Copies the element `index`, which must be below a result of `written` in this thread, to `out`, and returns its size in words.
  /// Returns nothing if the element was overwritten: the content of `out` then has no meaning. Thread: any. Realtime-safe: yes.
  [[nodiscard]] std::optional<std::size_t> read(std::uint64_t index, std::span<Word> out) const noexcept {
    const Atomic<Word>* const slot = slot_of(index);
    const std::size_t size = std::min<std::size_t>(slot[0].load(std::memory_order_acquire), out.size());  // as below: pairs with write()
    for (std::size_t word = 0; word < size; ++word) out[word] = slot[word + 1].load(std::memory_order_acquire);
    const bool is_whole = begun_.load(std::memory_order_acquire) - index <= capacity();  // pairs with write()
    return is_whole ? std::optional(size) : std::nullopt;
  }

 private:
  static constexpr std::size_t kCacheLine = 64;

  [[nodiscard]] std::size_t stride() const noexcept { return slot_words_ + 1; }  // the first word of a slot is the size of its element
  [[nodiscard]] Atomic<Word>* slot_of(std::uint64_t index) const noexcept { return &words_[(index % slots_) * stride()]; }

  std::size_t slot_words_;
  std::size_t slots_;
  std::unique_ptr<Atomic<Word>[]> words_;
  alignas(kCacheLine) Atomic<std::uint64_t> begun_{0};  ///< Number of elements of which a word may have been written.
  Atomic<std::uint64_t> written_{0};                    ///< Number of complete elements.
};

}  // namespace dts::core
