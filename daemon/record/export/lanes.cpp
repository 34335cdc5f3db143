// SPDX-License-Identifier: Apache-2.0
#include "record/export/lanes.h"

#include <exception>
#include <utility>

namespace dts::record {
namespace {

constexpr std::size_t kMostQueuedValues = 1U << 20U;  // 8 MiB: some seconds of the fastest rig

std::size_t values_of(const RecordedItem& item) {
  const auto* scans = std::get_if<RecordedScans>(&item);
  return scans != nullptr ? scans->values.size() + 1 : 1;
}

}  // namespace

Lanes::Lanes(std::size_t count, Work work) : work_(std::move(work)) {
  for (std::size_t lane = 0; lane < count; ++lane) {
    lanes_.push_back(std::make_unique<Lane>());
    lanes_.back()->thread = std::jthread([this, &own = *lanes_.back()] { run(own); });
  }
}

Lanes::~Lanes() {
  has_failed_.store(true, std::memory_order_relaxed);
  end_all();
}

void Lanes::give(std::size_t lane, RecordedItem&& item) {
  Lane& own = *lanes_[lane];
  std::unique_lock lock(own.mutex);
  own.changed.wait(lock, [&] { return own.queued_values < kMostQueuedValues || has_failed(); });
  own.queued_values += values_of(item);
  own.items.push_back(std::move(item));
  own.changed.notify_all();
}

core::Status Lanes::finish() {
  end_all();
  for (const auto& lane : lanes_) {
    if (!lane->status) return lane->status;
  }
  return {};
}

void Lanes::end_all() {
  for (const auto& lane : lanes_) {
    const std::lock_guard lock(lane->mutex);
    lane->is_last_given = true;
    lane->changed.notify_all();
  }
  for (const auto& lane : lanes_) {
    if (lane->thread.joinable()) lane->thread.join();
  }
}

void Lanes::run(Lane& lane) {
  while (true) {
    std::unique_lock lock(lane.mutex);
    lane.changed.wait(lock, [&] { return !lane.items.empty() || lane.is_last_given; });
    if (lane.items.empty()) return;
    const RecordedItem item = std::move(lane.items.front());
    lane.items.pop_front();
    lane.queued_values -= values_of(item);
    lane.changed.notify_all();
    lock.unlock();
    if (!has_failed()) work_on(lane, item);
  }
}

/// Runs the work on one item. The work throws only if there is no memory left.
void Lanes::work_on(Lane& lane, const RecordedItem& item) {
  try {
    lane.status = work_(item);
  } catch (const std::exception& error) {
    lane.status = core::fail(core::ErrorCode::Failed, std::string("cannot export: ") + error.what());
  }
  if (!lane.status) has_failed_.store(true, std::memory_order_relaxed);
}

}  // namespace dts::record
