// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <dirent.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <fstream>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "core/clock.h"

namespace dts::test {

/// Time of this process alone, for everything that a test runs in it. It passes only while every other thread of the process sleeps: on a
/// busy machine a thread that waits for its turn on a core stops the time. Rarely a thread is late all the same, by one step: the threads
/// are looked at one after the other. If A is looked at while it sleeps, and B then wakes A and sleeps before its own turn, both count as
/// asleep. The next look finds A awake. The time runs faster than the machine's when there is little to do.
class PatientClock final : public core::Clock {
 public:
  /// `step_ns`: time passes in such steps, each in a third of a millisecond or more of the machine's time.
  explicit PatientClock(std::int64_t step_ns = core::kNanosecondsPerMillisecond) : step_ns_(step_ns) {}
  ~PatientClock() override { stop(); }
  PatientClock(const PatientClock&) = delete;
  PatientClock& operator=(const PatientClock&) = delete;

  /// Lets time pass. Calls `after_step` after each step, from the clock's own thread.
  void start(std::function<void()> after_step = [] {}) {
    after_step_ = std::move(after_step);
    thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  }
  void stop() {
    thread_.request_stop();
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_.load(std::memory_order_acquire); }  // pairs with run()
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    std::unique_lock lock(mutex_);
    stepped_.wait(lock, [&] { return now_ns() >= deadline_ns; });
  }

 private:
  /// From step to step at least, of the machine's time: waits for transfers end by the machine's time, and must not cost much of ours.
  static constexpr std::chrono::microseconds kPause{250};

  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      std::this_thread::sleep_for(kPause);
      if (!do_all_others_sleep()) continue;
      {
        const std::lock_guard lock(mutex_);
        now_ns_.fetch_add(step_ns_, std::memory_order_release);  // pairs with now_ns()
      }
      stepped_.notify_all();
      after_step_();
    }
  }
  static bool do_all_others_sleep() {
    const std::unique_ptr<DIR, CloseDirectory> threads(::opendir("/proc/self/task"));
    const std::string own = std::to_string(::gettid());
    for (const dirent* entry = ::readdir(threads.get()); entry != nullptr; entry = ::readdir(threads.get())) {
      const std::string thread = entry->d_name;
      if (thread.front() == '.' || thread == own) continue;
      const char state = state_of(thread);
      if (state == 'R' || state == 'D') return false;  // runs, waits for a core or waits for a disk
    }
    return true;
  }
  /// The state letter of a thread in proc_pid_stat(5); 'X' when the thread has ended.
  static char state_of(const std::string& thread) {
    std::ifstream stat("/proc/self/task/" + thread + "/stat");
    std::string line;
    std::getline(stat, line);
    const std::size_t end_of_name = line.rfind(") ");
    return end_of_name == std::string::npos || end_of_name + 2 >= line.size() ? 'X' : line[end_of_name + 2];
  }
  struct CloseDirectory {
    void operator()(DIR* directory) const noexcept { ::closedir(directory); }
  };

  std::int64_t step_ns_;
  std::atomic<std::int64_t> now_ns_{core::SystemClock().now_ns()};
  std::mutex mutex_;
  std::condition_variable stepped_;
  std::function<void()> after_step_;
  std::jthread thread_;
};

}  // namespace dts::test
