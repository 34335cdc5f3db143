// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace dts::gateway {

/// Does long work on threads of its own ("archive"), each one piece at a time, started in order.
class Worker {
 public:
  static constexpr std::size_t kMostWaiting = 8;  ///< In addition to the work in progress.

  /// Runs on the io thread when the work is done.
  using Answer = std::function<void()>;
  /// Must end soon when a stop is requested.
  using Work = std::function<Answer(const std::stop_token& stop)>;

  explicit Worker(boost::asio::io_context& io, std::size_t threads = 1);
  /// Requests the work in progress to stop and waits for it. Waiting work never starts, and no result is passed on any more.
  ~Worker() { request_stop(); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Returns false if too much work is waiting. Thread: io.
  [[nodiscard]] bool submit(Work work);

 private:
  void request_stop() noexcept {
    for (std::jthread& thread : threads_) thread.request_stop();
  }
  void run(const std::stop_token& stop);

  boost::asio::io_context& io_;
  std::shared_ptr<bool> is_alive_ = std::make_shared<bool>(true);  ///< Ends with this object: read on the io thread only.
  std::size_t not_done_ = 0;                                       ///< Thread: io.
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Work> waiting_;
  std::vector<std::jthread> threads_;  // last: they end before the other members are destroyed
};

}  // namespace dts::gateway
