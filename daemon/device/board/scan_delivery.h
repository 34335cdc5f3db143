// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/clock.h"
#include "device/board/scan_source.h"
#include "device/device.h"

namespace dts::device::board {

/// Name of the check that reports why a scan broke off.
inline constexpr const char* kBreakOffCheck = "the scan does not break off";

/// The path from a source to blocks: waits, delivers, and handles a silent board. Thread: the reader, except `findings`. Realtime-safe:
/// yes; a silent board gets questions, each of which may take 100 ms.
class ScanDelivery {
 public:
  /// `is_interrupted`: makes `read` return early, once. All references must outlive the delivery.
  ScanDelivery(ScanSource& source, core::Clock& clock, std::atomic<bool>& is_interrupted, std::size_t max_block_scans);

  /// Works as Device::read in state Streaming; repeats Broken and Gone.
  [[nodiscard]] ReadResult read(core::Block& block, std::int64_t deadline_ns) noexcept;
  [[nodiscard]] bool has_more() noexcept { return !source_.has_trouble() && source_.queue().size() >= max_block_scans_; }
  /// Number of scans that have arrived and were not delivered. Thread: the reader, or the owner after the reader's last `read`.
  [[nodiscard]] std::size_t waiting() noexcept { return source_.queue().size(); }
  /// Returns the results of this scan's checks so far. Thread: any.
  [[nodiscard]] std::vector<DeviceCheck> findings() const;

 private:
  /// What was done about a silent board since its last scan.
  enum class Silence : std::uint8_t { None, Asked, StartedAgain };

  [[nodiscard]] bytes::ReadEnd fill(std::size_t wanted, std::int64_t wait_until_ns, std::int64_t limit_ns) noexcept;
  void check_rate() noexcept;
  void deliver(core::Block& block, std::size_t wanted) noexcept;
  [[nodiscard]] std::int64_t silent_at_ns() noexcept;
  void handle_silence(std::int64_t now_ns) noexcept;
  [[nodiscard]] ReadResult report_trouble() noexcept;

  ScanSource& source_;
  core::Clock& clock_;
  std::atomic<bool>& is_interrupted_;
  std::size_t max_block_scans_;
  std::uint64_t delivered_ = 0;  ///< Scans of this segment.
  std::int64_t published_ns_;    ///< Host time of the newest block; ensures that times never decrease.
  Silence silence_ = Silence::None;
  std::int64_t silence_step_ns_ = 0;  ///< When the silent board was asked or started.
  std::atomic<double> rate_error_{0.0};
  std::atomic<double> drift_ppm_{0.0};
  std::atomic<bool> is_judged_{false};
  std::atomic<std::uint64_t> values_{0};
  std::atomic<std::uint64_t> outside_{0};  ///< Values outside the range.
  /// As InputCounts, for the report.
  std::atomic<std::uint64_t> good_{0};
  std::atomic<std::uint64_t> damaged_{0};
  std::atomic<std::uint64_t> rejected_{0};
};

}  // namespace dts::device::board
