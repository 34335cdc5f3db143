// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/clock.h"
#include "core/spsc_ring.h"
#include "device/usb/usb_port.h"

namespace dts::device::usb {

/// How the data of a stream travel.
struct StreamShape {
  std::uint8_t endpoint = 0x81;
  std::size_t transfer_bytes = 64;   ///< A multiple of the endpoint's packet size.
  std::size_t transfer_count = 32;   ///< In flight at once.
  std::size_t buffer_chunks = 1024;  ///< Finished transfers that may wait for the reader.
};

/// What one finished transfer brought. A status other than Completed is the last chunk of its transfer: it is not resubmitted.
struct Chunk {
  UsbStatus status = UsbStatus::Completed;
  std::int64_t stamp_ns = 0;        ///< `Clock::raw_ns` when the transfer was found finished.
  std::size_t length = 0;           ///< Bytes in use.
  std::vector<std::uint8_t> bytes;  ///< As large as a transfer, taken once.
};

/// A never ending bulk IN stream: keeps transfers in flight and hands what they bring to one reader.
///
///     event thread: on_transfer: stamp, copy, submit again --SpscRing--> reader: front, release
///
/// Transfers are freed only when the last callback is over. Callbacks allocate, lock, log and wait for nothing of their own; libusb
/// does inside `submit` and around them, in the event thread. The reader shares nothing but the ring with it.
class BulkStream final : private TransferListener {
 public:
  /// Takes all memory. `port` and `clock` outlive the stream; the port has no other prepared transfers.
  [[nodiscard]] static core::Result<std::unique_ptr<BulkStream>> create(UsbPort& port, const StreamShape& shape, core::Clock& clock);
  /// `stop` must have returned true before.
  ~BulkStream();
  BulkStream(const BulkStream&) = delete;
  BulkStream& operator=(const BulkStream&) = delete;

  /// Puts all transfers into flight. On failure some may be: `stop` then.
  [[nodiscard]] UsbStatus start() noexcept;
  /// Ends all transfers and waits for their callbacks, at most `patience_ms` of real waiting; false: some have not come back,
  /// and stream and port must never be freed. Chunks not read are discarded. Idempotent.
  [[nodiscard]] bool stop(int patience_ms) noexcept;

  /// The oldest unread chunk or nullptr. Thread: the reader. Realtime-safe: yes.
  [[nodiscard]] Chunk* front() noexcept { return chunks_.front(); }
  void release() noexcept { chunks_.release(); }
  /// Chunks that found no room: the bytes of the stream are no longer whole. Thread: any. Realtime-safe: yes.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return chunks_.dropped(); }
  [[nodiscard]] int in_flight() const noexcept { return in_flight_.load(std::memory_order_acquire); }  // pairs with on_transfer

 private:
  BulkStream(UsbPort& port, const StreamShape& shape, core::Clock& clock);
  void hand_over(UsbStatus status, std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept;
  void on_transfer(std::size_t index, UsbStatus status, std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept override;

  UsbPort& port_;
  StreamShape shape_;
  core::Clock& clock_;
  core::SpscRing<Chunk> chunks_;
  std::atomic<bool> is_stopping_{false};
  std::atomic<int> in_flight_{0};
  bool is_released_ = false;  ///< The port has freed the transfers.
};

}  // namespace dts::device::usb
