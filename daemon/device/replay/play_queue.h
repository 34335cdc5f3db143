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

/// The next item of a recording.
struct PlayedItem {
  enum class Kind : std::uint8_t { Scans, Gap, End };
  Kind kind = Kind::End;
  core::Block block;              ///< For Scans.
  core::Gap gap{};                ///< For Gap.
  std::array<char, 512> fault{};  ///< For End: why playback ended early; empty at the end of the file.
};

/// Reads a recording ahead on its own thread, so that the reader does not access files or allocate.
///
///     play-ahead thread: Recording --items--> ScanMerger --blocks--> [ring] --> front, release
class PlayQueue {
 public:
  /// `recording` must outlive the queue; between `start` and `stop` only the queue may read it.
  PlayQueue(record::Recording& recording, const RecordedDevice& device);
  ~PlayQueue() { stop(); }
  PlayQueue(const PlayQueue&) = delete;
  PlayQueue& operator=(const PlayQueue&) = delete;

  /// Plays from the beginning; with `loops` repeatedly, with a gap without missing scans between two rounds. Waits up to 1 s for the first
  /// item. Fails as the recording's `rewind`. Thread: control.
  [[nodiscard]] core::Status start(bool loops);
  void stop() noexcept;

  /// Returns the next item, or nullptr if none arrives within `patience_ms`. Thread: one reader. Realtime-safe: yes.
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
  std::uint64_t handed_over_ = 0;  ///< Number of items; owned by the play-ahead thread.
  std::jthread thread_;
};

}  // namespace dts::device::replay
