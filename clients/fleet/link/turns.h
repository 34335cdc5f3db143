// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

namespace dts::fleet::link {

/// Whose turn it is: the servers are tried one after the other. Has no clock. Thread: one.
class Turns {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kSteady{20};  ///< A connection that lasts longer was a success.

  explicit Turns(std::size_t servers) noexcept : servers_(servers) {}

  /// Index of the server to try.
  [[nodiscard]] std::size_t server() const noexcept { return tries_ % servers_; }
  /// The server has accepted the connection.
  void connected(Time now) noexcept { connected_at_ = now; }
  /// The connection, or the try, has ended: the next server has its turn. Returns how often all servers have failed before. A try that took
  /// long without a connection has failed, too.
  [[nodiscard]] std::size_t ended(Time now) noexcept {
    if (connected_at_ && now - *connected_at_ > kSteady) tries_ = 0;
    connected_at_.reset();
    return tries_++ / servers_;
  }

 private:
  std::size_t servers_;
  std::size_t tries_ = 0;
  std::optional<Time> connected_at_{};
};

}  // namespace dts::fleet::link
