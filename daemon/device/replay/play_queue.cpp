// SPDX-License-Identifier: Apache-2.0
#include "device/replay/play_queue.h"

#include <algorithm>
#include <exception>

#include "core/thread.h"
#include "device/replay/scan_merger.h"

namespace dts::device::replay {
namespace {

constexpr std::size_t kBlockScans = 256;
constexpr std::size_t kBlocks = 64;
constexpr int kRoomPatienceMs = 50;     // limit for noticing a stop
constexpr int kFirstPatienceMs = 1000;  // with a slower disk, `read` waits: it can be interrupted

}  // namespace

PlayQueue::PlayQueue(record::Recording& recording, const RecordedDevice& device)
    : recording_(recording),
      device_(device),
      ring_(kBlocks, PlayedItem{.block = core::Block(device.description.channels.size(), kBlockScans)}) {}

core::Status PlayQueue::start(bool loops) {
  stop();
  while (ring_.front() != nullptr) ring_.release();
  item_bell_.clear();
  DTS_TRY(recording_.rewind());
  thread_ = std::jthread([this, loops](const std::stop_token& stop) {
    (void)core::configure_this_thread("replay-ahead", {});
    try {
      run(stop, loops);
    } catch (const std::exception& error) {  // std::bad_alloc
      end(error.what(), stop);
    }
  });
  (void)front(kFirstPatienceMs);
  return {};
}

void PlayQueue::stop() noexcept {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  room_bell_.ring();
  thread_.join();
}

PlayedItem* PlayQueue::front(int patience_ms) noexcept {
  PlayedItem* item = ring_.front();
  if (item == nullptr && item_bell_.wait(patience_ms)) item = ring_.front();
  return item;
}

void PlayQueue::release() noexcept {
  ring_.release();
  room_bell_.ring();
}

PlayedItem* PlayQueue::slot(const std::stop_token& stop) {
  PlayedItem* free = ring_.claim();
  while (free == nullptr && !stop.stop_requested()) {
    room_bell_.wait(kRoomPatienceMs);
    free = ring_.claim();
  }
  return free;
}

void PlayQueue::hand_over() noexcept {
  ++handed_over_;
  ring_.commit();
  item_bell_.ring();
}

void PlayQueue::run(const std::stop_token& stop, bool loops) {
  do {
    const std::uint64_t before = handed_over_;
    if (const auto played = play_once(stop); !played) return end(core::to_string(played.error()), stop);
    if (!loops) return end("", stop);
    if (handed_over_ == before) return end("it has no scan to repeat", stop);
    if (const auto rewound = recording_.rewind(); !rewound) return end(core::to_string(rewound.error()), stop);
    PlayedItem* again = slot(stop);
    if (again == nullptr) return;
    again->kind = PlayedItem::Kind::Gap;
    again->gap = {.reason = core::GapReason::Silence, .missing_scans = 0, .is_exact = true};
    hand_over();
  } while (!stop.stop_requested());
}

core::Status PlayQueue::play_once(const std::stop_token& stop) {
  ScanMerger merger(device_);
  while (!stop.stop_requested()) {
    DTS_TRY_ASSIGN(const auto item, recording_.next());
    if (!item) break;
    DTS_TRY(merger.add(*item));
    if (!hand_out(merger, stop)) return {};
  }
  merger.finish();
  (void)hand_out(merger, stop);
  return {};
}

/// Passes all ready scans to the reader; returns false if stopped.
bool PlayQueue::hand_out(ScanMerger& merger, const std::stop_token& stop) {
  while (PlayedItem* next = slot(stop)) {
    switch (merger.take(next->block, next->gap)) {
      case ScanMerger::Taken::Nothing: return true;
      case ScanMerger::Taken::Scans: next->kind = PlayedItem::Kind::Scans; break;
      case ScanMerger::Taken::Gap: next->kind = PlayedItem::Kind::Gap; break;
    }
    hand_over();
  }
  return false;
}

void PlayQueue::end(std::string_view fault, const std::stop_token& stop) {
  PlayedItem* last = slot(stop);
  if (last == nullptr) return;
  last->kind = PlayedItem::Kind::End;
  last->fault.fill('\0');
  std::copy_n(fault.begin(), std::min(fault.size(), last->fault.size() - 1), last->fault.begin());
  hand_over();
}

}  // namespace dts::device::replay
