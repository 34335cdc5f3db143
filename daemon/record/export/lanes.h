// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "core/result.h"
#include "record/recording.h"

namespace dts::record {

/// Threads that convert items to text in parallel, because this is most of the work of an export. Each lane handles its items in order.
/// Thread: one calls `give`.
class Lanes {
 public:
  /// Runs on the lanes' threads, on several of them at the same time.
  using Work = std::function<core::Status(const RecordedItem& item)>;

  Lanes(std::size_t count, Work work);
  /// Discards the items that no thread has started.
  ~Lanes();
  Lanes(const Lanes&) = delete;
  Lanes& operator=(const Lanes&) = delete;

  [[nodiscard]] std::size_t count() const noexcept { return lanes_.size(); }
  /// Queues an item; waits while the lane's queue is full.
  void give(std::size_t lane, RecordedItem&& item);
  /// True if some work failed; the caller can stop early.
  [[nodiscard]] bool has_failed() const noexcept { return has_failed_.load(std::memory_order_relaxed); }
  /// Waits until all work is done; returns the first failure.
  [[nodiscard]] core::Status finish();

 private:
  struct Lane {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<RecordedItem> items;
    std::size_t queued_values = 0;
    bool is_last_given = false;
    core::Status status;
    std::jthread thread;  // last member: the thread ends before the other members are destroyed
  };
  void run(Lane& lane);
  void work_on(Lane& lane, const RecordedItem& item);
  void end_all();

  Work work_;
  std::atomic<bool> has_failed_ = false;  ///< Only for an early stop; `finish` reads the failure after the threads have ended.
  std::vector<std::unique_ptr<Lane>> lanes_{};
};

}  // namespace dts::record
