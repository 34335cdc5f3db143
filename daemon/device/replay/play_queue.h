// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <thread>

#include "core/block.h"
#include "core/doorbell.h"
#include "core/frame.h"
#include "core/spsc_ring.h"
#include "device/replay/recorded_device.h"
#include "record/recording.h"

namespace dts::device::replay {

/// What comes next out of a recording.
struct PlayedItem {
  enum class Kind : std::uint8_t { Scans, Gap, End };
  Kind kind = Kind::End;
  core::Block block;              ///< Of Scans.
  core::Gap gap{};                ///< Of Gap.
  std::array<char, 512> fault{};  ///< Of End: why it came early; empty at the end of the file.
};

/// Reads a recording ahead on a thread of its own, so that whoever plays it touches no file and takes no memory.
///
///     play-ahead thread: Recording --items--> ScanMerger --blocks--> [ring] --> front, release
class PlayQueue {
 public:
  /// `recording` outlives this and is read by nobody else between `start` and `stop`.
  PlayQueue(record::Recording& recording, const RecordedDevice& device);
  ~PlayQueue() { stop(); }
  PlayQueue(const PlayQueue&) = delete;
  PlayQueue& operator=(const PlayQueue&) = delete;

  /// From the beginning; with `loops` again and again, with a gap without missing scans between. Waits a moment for the first item.
  /// Fails as the recording's `rewind`. Thread: control.
  [[nodiscard]] core::Status start(bool loops);
  void stop() noexcept;

  /// The next item, or nullptr when `patience_ms` have passed without. Thread: one reader. Realtime-safe: yes.
  [[nodiscard]] PlayedItem* front(int patience_ms) noexcept;
  void release() noexcept;

 private:
  void run(const std::stop_token& stop, bool loops);
  [[nodiscard]] core::Status play_once(const std::stop_token& stop);
  [[nodiscard]] bool hand_out(class ScanMerger& merger, const std::stop_token& stop);
  [[nodiscard]] PlayedItem* slot(const std::stop_token& stop);
  void hand_over() noexcept;
  void end(std::string_view fault, const std::stop_token& stop);

  record::Recording& recording_;
  const RecordedDevice& device_;
  core::SpscRing<PlayedItem> ring_;
  core::Doorbell item_bell_;
  core::Doorbell room_bell_;
  std::uint64_t handed_over_ = 0;  ///< Items; the play-ahead thread's.
  std::jthread thread_;
};

}  // namespace dts::device::replay
