// SPDX-License-Identifier: Apache-2.0
#include "session/record_tap.h"

namespace dts::session {

RecordTap::RecordTap(std::size_t slots, const pipeline::Pipeline& pipeline)
    : pipeline_(pipeline), ring_(slots, Slot{.frame = pipeline.make_frame()}), state_(pipeline.state_size()) {}

void RecordTap::follow() noexcept {
  const std::uint64_t wanted = wanted_.load(std::memory_order_acquire);  // pairs with open() and close()
  if (wanted == current_) return;
  if (current_ != 0) {
    Slot* const slot = ring_.claim();
    if (slot == nullptr) return;  // full: the end mark comes when there is room
    slot->take = current_;
    slot->is_end = true;
    ring_.commit();
  }
  if (wanted != 0) pipeline_.save(state_);
  current_ = wanted;
}

void RecordTap::offer(const core::Frame& frame) noexcept {
  if (current_ == 0) return;
  Slot* const slot = ring_.claim();
  if (slot == nullptr) return ring_.drop();
  slot->frame.copy_from(frame);
  slot->take = current_;
  slot->is_end = false;
  ring_.commit();
}

}  // namespace dts::session
