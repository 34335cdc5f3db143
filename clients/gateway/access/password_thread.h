// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "gateway/access/secret.h"

namespace dts::gateway {

/// Compares passwords on its own thread ("password"), one at a time: each comparison needs 64 MiB and a tenth of a second.
class PasswordThread {
 public:
  using Compared = std::function<void(bool is_right)>;

  using IsPassword = std::function<bool(const std::string& hash, const Secret& password)>;

  PasswordThread(boost::asio::io_context& io, IsPassword is_password);
  /// Waits for a comparison in progress; its result is dropped.
  ~PasswordThread() = default;
  PasswordThread(const PasswordThread&) = delete;
  PasswordThread& operator=(const PasswordThread&) = delete;

  /// Calls `compared` on the io thread. Do not call this again before that. Thread: io.
  void compare(std::string hash, Secret password, Compared compared);

 private:
  struct Job {
    std::string hash;
    Secret password;
    Compared compared;
  };
  void run(const std::stop_token& stop);

  boost::asio::io_context& io_;
  IsPassword is_password_;                                         ///< Called on the thread "password".
  std::shared_ptr<bool> is_alive_ = std::make_shared<bool>(true);  ///< Ends with this object: read on the io thread only.
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::unique_ptr<Job> job_;
  std::jthread thread_;  // last: ends before the other members are destroyed
};

}  // namespace dts::gateway
