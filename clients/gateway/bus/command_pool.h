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

/// Sends commands to the daemon from a few threads ("command"), because some answers need long (a stop waits for the disk). Commands that a
/// viewer may send, which only read, have their own threads and queue: they never delay a stop.
class CommandPool {
 public:
  static constexpr std::size_t kThreads = 4;       ///< For reading commands, and again for the other commands.
  static constexpr std::size_t kMostWaiting = 64;  ///< The same, including the commands being sent.

  CommandPool(boost::asio::io_context& io, std::string endpoint);
  /// Drops waiting commands, and stops waiting for answers to commands already sent.
  ~CommandPool();
  CommandPool(const CommandPool&) = delete;
  CommandPool& operator=(const CommandPool&) = delete;

  using Answered = std::function<void(client::Result<v1::Response>)>;
  /// Calls `answered` on the io thread; immediately with LimitExceeded if too many commands wait. Thread: io.
  void submit(v1::Request request, Answered answered);

 private:
  struct Lane {
    std::size_t taken = 0;  ///< Commands waiting or being sent. Thread: io.
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
