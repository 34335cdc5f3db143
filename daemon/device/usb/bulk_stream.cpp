// SPDX-License-Identifier: Apache-2.0
#include "device/usb/bulk_stream.h"

#include <algorithm>
#include <string>

namespace dts::device::usb {
namespace {

constexpr std::size_t kMostTransfers = 1024;
constexpr std::size_t kMostTransferBytes = 64U * 1024U;
constexpr std::size_t kMostBufferBytes = 64U * 1024U * 1024U;
constexpr std::int64_t kCancelSliceNs = 5 * core::kNanosecondsPerMillisecond;

core::Status check(const StreamShape& shape) {
  const bool is_fine = shape.transfer_count >= 1 && shape.transfer_count <= kMostTransfers && shape.transfer_bytes >= 1 &&
                       shape.transfer_bytes <= kMostTransferBytes && shape.buffer_chunks >= 1 &&
                       shape.buffer_chunks <= kMostBufferBytes / shape.transfer_bytes;
  if (is_fine) return {};
  return core::fail(core::ErrorCode::LimitExceeded, "cannot stream with " + std::to_string(shape.transfer_count) + " transfers of " +
                                                        std::to_string(shape.transfer_bytes) + " bytes and a buffer of " +
                                                        std::to_string(shape.buffer_chunks));
}

}  // namespace

core::Result<std::unique_ptr<BulkStream>> BulkStream::create(UsbPort& port, const StreamShape& shape, core::Clock& clock) {
  DTS_TRY(check(shape));
  std::unique_ptr<BulkStream> stream(new BulkStream(port, shape, clock));
  if (auto prepared = port.prepare_transfers(shape.endpoint, shape.transfer_count, shape.transfer_bytes, *stream); !prepared) {
    stream->is_released_ = true;
    return tl::make_unexpected(prepared.error());
  }
  return stream;
}

BulkStream::BulkStream(UsbPort& port, const StreamShape& shape, core::Clock& clock)
    : port_(port),
      shape_(shape),
      clock_(clock),
      chunks_(shape.buffer_chunks, Chunk{UsbStatus::Completed, 0, 0, std::vector<std::uint8_t>(shape.transfer_bytes)}) {}

BulkStream::~BulkStream() {
  if (!is_released_) port_.release_transfers();  // the stream was never started
}

UsbStatus BulkStream::start() noexcept {
  for (std::size_t i = 0; i < shape_.transfer_count; ++i) {
    // Counted before it is submitted: its callback may run before `submit` returns.
    in_flight_.fetch_add(1, std::memory_order_relaxed);  // ordered by the locks inside submit
    const UsbStatus submitted = port_.submit(i);
    if (submitted == UsbStatus::Completed) continue;
    in_flight_.fetch_sub(1, std::memory_order_release);  // pairs with in_flight()
    return submitted;
  }
  return UsbStatus::Completed;
}

bool BulkStream::stop(int patience_ms) noexcept {
  is_stopping_.store(true, std::memory_order_release);  // pairs with on_transfer
  const std::int64_t deadline_ns = clock_.now_ns() + patience_ms * core::kNanosecondsPerMillisecond;
  while (in_flight() > 0) {
    // Repeated in every slice: a running callback may have submitted a transfer again just after it was cancelled.
    for (std::size_t i = 0; i < shape_.transfer_count; ++i) port_.cancel(i);
    const std::int64_t now_ns = clock_.now_ns();
    if (now_ns >= deadline_ns) return false;
    port_.wait(std::min(deadline_ns, now_ns + kCancelSliceNs));
  }
  if (!is_released_) port_.release_transfers();
  is_released_ = true;
  while (chunks_.front() != nullptr) chunks_.release();
  return true;
}

void BulkStream::hand_over(UsbStatus status, std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept {
  Chunk* const chunk = chunks_.claim();
  if (chunk == nullptr) {
    chunks_.drop();
    return;
  }
  chunk->status = status;
  chunk->stamp_ns = stamp_ns;
  chunk->length = std::min(bytes.size(), chunk->bytes.size());
  std::copy_n(bytes.begin(), chunk->length, chunk->bytes.begin());
  chunks_.commit();
}

void BulkStream::on_transfer(std::size_t index, UsbStatus status, std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept {
  hand_over(status, bytes, stamp_ns);
  if (status == UsbStatus::Completed && !is_stopping_.load(std::memory_order_acquire)) {  // pairs with stop()
    const UsbStatus again = port_.submit(index);
    if (again == UsbStatus::Completed) return;  // still in flight
    hand_over(again, {}, stamp_ns);
  }
  in_flight_.fetch_sub(1, std::memory_order_release);  // must be the last statement: then `stop` frees everything; pairs with in_flight()
}

}  // namespace dts::device::usb
