// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>

namespace dts::core {

/// Runs jobs one after another on a thread of its own, so that long calculations do not delay the thread that needs their results.
///
///     auto analysis = worker.run([series] { return analyse(series); });    // any thread; does not wait
///     ...
///     if (is_ready(analysis)) use(analysis.get());
///
/// A job must not throw: return a Result.
class Worker {
 public:
  /// `name` is the name of the thread (only the first 15 characters).
  explicit Worker(std::string name);
  /// Waits for the job that runs; drops the jobs that wait. Their futures must not be used afterwards.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Thread: any.
  template <class Job>
  [[nodiscard]] std::future<std::invoke_result_t<Job>> run(Job job) {
    auto task = std::make_shared<std::packaged_task<std::invoke_result_t<Job>()>>(std::move(job));
    auto result = task->get_future();
    post([task = std::move(task)] { (*task)(); });
    return result;
  }

 private:
  void post(std::function<void()> task);
  void work(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any has_task_;
  std::deque<std::function<void()>> tasks_;
  std::jthread thread_;
};

/// Returns whether `get` returns at once.
template <class Value>
[[nodiscard]] bool is_ready(const std::future<Value>& future) {
  return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace dts::core
