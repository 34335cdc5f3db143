// SPDX-License-Identifier: Apache-2.0
// Scans from the interrupt of the converter to the main loop, and the exact number of lost scans: the queue was full.
#pragma once

#include <stdint.h>

#include "firmware/frame.h"

namespace firmware {

/// Why scans are lost; the values of the frame LOST.
enum class Reason : uint8_t { kBufferFull = 1, kLate = 2, kStopped = 4 };

/// One writer (an interrupt) and one reader (the main loop). `Guard` keeps interrupts out while it lives.
/// After a loss, the queue accepts nothing before the reader has taken all scans and the number of lost ones. So there is never more than
/// one break in the queue, and it is always at the end: the reader knows the counter of every scan without a counter in the queue.
template <uint8_t Channels, uint8_t Scans, class Guard>
class ScanQueue {
  static_assert(Scans >= 2 && Scans <= 128 && (Scans & (Scans - 1)) == 0, "an index is one byte and wraps at a power of two");

 public:
  /// Writer: returns where the next scan goes, or nullptr if there is no room. The writer then calls lose().
  int16_t* slot() {
    if (lost_ != 0 || size() == Scans) return nullptr;
    return codes_[written_ & (Scans - 1)];
  }
  /// Writer: the scan in slot() is complete.
  void commit() {
    barrier();
    written_ = static_cast<uint8_t>(written_ + 1);
  }
  /// Writer: scans after the last committed one are lost.
  void lose(uint16_t scans, Reason reason) {
    if (lost_ == 0) reason_ = reason;
    lost_ = lost_ + scans;
  }

  /// Reader.
  uint8_t size() const { return static_cast<uint8_t>(written_ - read_); }
  const int16_t* front() const { return codes_[read_ & (Scans - 1)]; }
  void pop() {
    barrier();
    read_ = static_cast<uint8_t>(read_ + 1);
  }
  /// Reader: returns whether scans are lost after those in the queue.
  bool has_loss() const {
    const Guard guard;
    return lost_ != 0;
  }
  struct Loss {
    uint32_t scans;
    Reason reason;
  };
  /// Reader, only if the queue is empty: returns the loss. From then on, the queue accepts scans again.
  Loss take_loss() {
    const Guard guard;
    const Loss loss{lost_, reason_};
    lost_ = 0;
    return loss;
  }

 private:
  int16_t codes_[Scans][Channels] = {};
  volatile uint8_t written_ = 0;
  volatile uint8_t read_ = 0;
  volatile uint32_t lost_ = 0;
  volatile Reason reason_ = Reason::kBufferFull;
};

}  // namespace firmware
