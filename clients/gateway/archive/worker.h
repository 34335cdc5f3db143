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

namespace dts::gateway {

/// Does long work on a thread of its own ("archive"), one piece at a time, in order.
class Worker {
 public:
  static constexpr std::size_t kMostWaiting = 8;  ///< Besides the one under way.

  /// What is to be told afterwards, on the io thread.
  using Told = std::function<void()>;
  /// Is to come to its end soon when a stop is asked for.
  using Work = std::function<Told(const std::stop_token& stop)>;

  explicit Worker(boost::asio::io_context& io);
  /// Asks the work under way to stop and waits for it; what waits is never begun, and nothing more is told.
  ~Worker() = default;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// False: too much is waiting. Thread: io.
  [[nodiscard]] bool submit(Work work);

 private:
  void run(const std::stop_token& stop);

  boost::asio::io_context& io_;
  std::shared_ptr<bool> is_alive_ = std::make_shared<bool>(true);  ///< Goes with this object: looked at on the io thread only.
  std::size_t not_done_ = 0;                                       ///< Thread: io.
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Work> waiting_;
  std::jthread thread_;  // last: ends before the rest goes
};

}  // namespace dts::gateway
