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

/// Sizes of the transfers and of the buffer of a stream.
struct StreamShape {
  std::uint8_t endpoint = 0x81;
  std::size_t transfer_bytes = 64;   ///< A multiple of the endpoint's packet size.
  std::size_t transfer_count = 32;   ///< Number of transfers in flight.
  std::size_t buffer_chunks = 1024;  ///< Number of finished transfers that may wait for the reader.
};

/// The data of one finished transfer. If the status is not Completed, the transfer is not submitted again.
struct Chunk {
  UsbStatus status = UsbStatus::Completed;
  std::int64_t stamp_ns = 0;        ///< `Clock::raw_ns` at the callback of the transfer.
  std::size_t length = 0;           ///< Number of received bytes in `bytes`.
  std::vector<std::uint8_t> bytes;  ///< As large as a transfer; allocated only once.
};

/// An endless bulk IN stream: keeps transfers in flight and passes their data to one reader.
///
///     event thread: on_transfer: stamp, copy, submit again --SpscRing--> reader: front, release
///
/// Transfers are freed only after the last callback has ended. Callbacks do not allocate, lock, log or wait; libusb locks and
/// allocates inside `submit` and around the callbacks, in the event thread. The reader shares only the ring with that thread.
class BulkStream final : private TransferListener {
 public:
  /// Allocates all memory. `port` and `clock` must outlive the stream; the port must have no other prepared transfers.
  [[nodiscard]] static core::Result<std::unique_ptr<BulkStream>> create(UsbPort& port, const StreamShape& shape, core::Clock& clock);
  /// After `start`, `stop` must have returned true before the destructor runs.
  ~BulkStream();
  BulkStream(const BulkStream&) = delete;
  BulkStream& operator=(const BulkStream&) = delete;

  /// Submits all transfers. After a failure some may be in flight: call `stop`.
  [[nodiscard]] UsbStatus start() noexcept;
  /// Cancels all transfers and waits for their callbacks, at most `patience_ms`. Returns false if some transfers did not end: then
  /// stream and port must not be freed until a later call returns true. Discards unread chunks. Idempotent.
  [[nodiscard]] bool stop(int patience_ms) noexcept;

  /// Returns the oldest unread chunk or nullptr. Thread: the reader. Realtime-safe: yes.
  [[nodiscard]] Chunk* front() noexcept { return chunks_.front(); }
  void release() noexcept { chunks_.release(); }
  /// Returns the number of dropped chunks; if it is not 0, bytes of the stream are missing. Thread: any. Realtime-safe: yes.
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
