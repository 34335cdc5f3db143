// SPDX-License-Identifier: Apache-2.0
#include "session/record_tap.h"

namespace dts::session {

RecordTap::RecordTap(std::size_t slots, const pipeline::Pipeline& pipeline)
    : pipeline_(pipeline), ring_(slots, Slot{.frame = pipeline.make_frame()}), state_(pipeline.state_size()) {}

void RecordTap::follow() noexcept {
  if (!end_closed()) return;
  const std::uint64_t opened = opened_.load(std::memory_order_acquire);  // pairs with open()
  if (current_ != 0 || opened == begun_) return;
  pipeline_.save(state_);
  lost_scans_ = 0;
  lost_events_ = 0;
  lost_gap_ = {};
  current_ = begun_ = opened;
  static_cast<void>(end_closed());  // a take may be closed before this thread saw it open; if the ring is full, the end mark follows later
}

/// Returns false if there was no room for the end mark.
bool RecordTap::end_closed() noexcept {
  if (current_ == 0 || closed_.load(std::memory_order_acquire) < current_) return true;  // pairs with close()
  Slot* const slot = ring_.claim();
  if (slot == nullptr) return false;
  slot->take = current_;
  slot->is_end = true;
  slot->frame.event_count = 0;
  slot->lost_scans = lost_scans_;
  slot->lost_events = lost_events_;
  ring_.commit();
  current_ = 0;
  return true;
}

void RecordTap::offer(const core::Frame& frame, const core::FrameEvents& events) noexcept {
  if (current_ == 0) return;
  Slot* const slot = ring_.claim();
  if (slot == nullptr) {
    lost_scans_ += frame.streams.front().count();
    lost_gap_ = core::merged(lost_gap_, frame.gap_before);
    return ring_.drop();
  }
  lost_events_ += events.lost() + events_.push(events);
  slot->frame.copy_from(frame);
  slot->frame.event_count = events_.take_count();
  slot->frame.gap_before = core::merged(lost_gap_, frame.gap_before);
  lost_gap_ = {};
  slot->take = current_;
  slot->is_end = false;
  slot->lost_scans = lost_scans_;
  slot->lost_events = lost_events_;
  ring_.commit();
}

}  // namespace dts::session
