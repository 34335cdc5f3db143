// SPDX-License-Identifier: Apache-2.0
#include "session/record_tap.h"

namespace dts::session {

RecordTap::RecordTap(const core::FrameRing& frames, const pipeline::Pipeline& pipeline)
    : frames_(frames), pipeline_(pipeline), state_(pipeline.state_size()), reader_(frames, frames.capacity()) {}

void RecordTap::close(const core::FramePosition& end) noexcept {
  end_ = end;
  closed_.store(takes_, std::memory_order_release);  // pairs with front()
}

void RecordTap::begin_take() noexcept {
  const std::uint64_t opened = opened_.load(std::memory_order_acquire);  // pairs with open(): the previous take has been read
  if (opened == begun_.load(std::memory_order_relaxed)) return;          // own value
  pipeline_.save(state_);
  begin_ = frames_.end();
  read_.store(begin_.frame, std::memory_order_relaxed);  // the record thread reads no take now
  begun_.store(opened, std::memory_order_release);       // pairs with front() and start_reading()
}

std::size_t RecordTap::waiting() const noexcept {
  if (begun_.load(std::memory_order_acquire) <= done_.load(std::memory_order_relaxed)) return 0;  // pairs with begin_take()
  const std::uint64_t read = read_.load(std::memory_order_relaxed);
  return static_cast<std::size_t>(frames_.written() - read);
}

/// Returns false if there is nothing to read of a new take.
bool RecordTap::start_reading() noexcept {
  const std::uint64_t done = done_.load(std::memory_order_relaxed);  // own value
  // `closed_` first: if this thread sees the end of a take, it also sees whether the rig thread had begun it. In the other order, a whole
  // take may lie between the two loads, and would look like one that was never begun.
  const std::uint64_t closed = closed_.load(std::memory_order_acquire);  // pairs with close()
  const std::uint64_t begun = begun_.load(std::memory_order_acquire);    // pairs with begin_take()
  if (begun > done) {
    take_ = begun;
    reader_.start_at(begin_);
  } else if (closed > done) {  // before the rig thread began it
    take_ = closed;
    reader_.start_at(end_);
  }
  return take_ != 0;
}

std::optional<RecordTap::Item> RecordTap::front() noexcept {
  if (take_ == 0 && !start_reading()) return std::nullopt;
  if (last_item_) return last_item_;
  const bool is_closed = closed_.load(std::memory_order_acquire) >= take_;  // pairs with close()
  const std::uint64_t lost_scans = reader_.lost_scans();
  const std::uint64_t lost_events = reader_.lost_events();
  const core::Frame* frame = is_closed && reader_.position().frame >= end_.frame ? nullptr : reader_.front();
  if (is_closed && (frame == nullptr || reader_.position().frame >= end_.frame)) return end(lost_scans, lost_events);
  if (frame == nullptr) return std::nullopt;
  return Item{
      .frame = frame, .events = reader_.events(), .take = take_, .lost_scans = reader_.lost_scans(), .lost_events = reader_.lost_events()};
}

/// Makes the end of the take. What lies between the last frame that was read and the end is lost.
RecordTap::Item RecordTap::end(std::uint64_t lost_scans, std::uint64_t lost_events) noexcept {
  const core::FramePosition& last = reader_.position();
  last_item_ = {.take = take_,
                .lost_scans = lost_scans + (end_.scans > last.scans ? end_.scans - last.scans : 0),
                .lost_events = lost_events + (end_.events > last.events ? end_.events - last.events : 0)};
  return *last_item_;
}

void RecordTap::release() noexcept {
  if (last_item_) {
    done_.store(take_, std::memory_order_release);  // pairs with is_done()
    take_ = 0;
    last_item_.reset();
    return;
  }
  reader_.release();
  read_.store(reader_.position().frame, std::memory_order_relaxed);  // the frame was copied: the rig thread needs nothing else
}

void RecordTap::note_waiting(std::int64_t now_ns) noexcept {
  peak_.note(waiting(), now_ns);
  waiting_.store(peak_);
}

}  // namespace dts::session
