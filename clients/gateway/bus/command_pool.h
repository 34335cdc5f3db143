// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <cstddef>
#include <functional>
#include <stop_token>
#include <string>

#include "dts/error.h"
#include "dts/v1/control.pb.h"

namespace dts::gateway {

/// Sends commands to the daemon from a few threads ("command"), since some answers take long (a stop waits for the disk). Commands that
/// only look, those a viewer may give, have threads and places of their own: however many there are, a stop is sent at once.
class CommandPool {
 public:
  static constexpr std::size_t kThreads = 4;       ///< Of those that look, and of the others.
  static constexpr std::size_t kMostWaiting = 64;  ///< The same, with those under way.

  CommandPool(boost::asio::io_context& io, std::string endpoint);
  /// What waits is given up, and so is waiting for the answers to what was sent.
  ~CommandPool();
  CommandPool(const CommandPool&) = delete;
  CommandPool& operator=(const CommandPool&) = delete;

  using Answered = std::function<void(client::Result<v1::Response>)>;
  /// `answered` is called on the io thread; at once with LimitExceeded when too many wait. Thread: io.
  void submit(v1::Request request, Answered answered);

 private:
  struct Lane {
    std::size_t taken = 0;  ///< Thread: io.
    boost::asio::thread_pool threads{kThreads};
  };
  [[nodiscard]] client::Result<v1::Response> send(const v1::Request& request) const;

  boost::asio::io_context& io_;
  std::string endpoint_;
  std::stop_source stop_;
  Lane looking_;
  Lane doing_;
};

}  // namespace dts::gateway
