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

/// Threads that turn items into text side by side: of hours at 1500 Hz that is most of the work. What is given to one lane is done in
/// order. Thread: one gives.
class Lanes {
 public:
  /// Called on the lanes' threads, by several at a time.
  using Work = std::function<core::Status(const RecordedItem& item)>;

  Lanes(std::size_t count, Work work);
  /// Throws away what has not been begun.
  ~Lanes();
  Lanes(const Lanes&) = delete;
  Lanes& operator=(const Lanes&) = delete;

  [[nodiscard]] std::size_t count() const noexcept { return lanes_.size(); }
  /// Waits while the lane has much to do.
  void give(std::size_t lane, RecordedItem&& item);
  /// Some work failed: to go on is useless.
  [[nodiscard]] bool has_failed() const noexcept { return has_failed_.load(std::memory_order_relaxed); }
  /// Waits until everything is done; the first failure.
  [[nodiscard]] core::Status finish();

 private:
  struct Lane {
    std::mutex mutex;
    std::condition_variable changed;
    std::deque<RecordedItem> items;
    std::size_t queued_values = 0;
    bool is_last_given = false;
    core::Status status;
    std::jthread thread;  // last: ends before the rest goes
  };
  void run(Lane& lane);
  void work_on(Lane& lane, const RecordedItem& item);
  void end_all();

  Work work_;
  std::atomic<bool> has_failed_ = false;  ///< Only a hint; the failure itself is read after the threads have ended.
  std::vector<std::unique_ptr<Lane>> lanes_{};
};

}  // namespace dts::record
