// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace dts::test {

/// Accepts connections as LabRecorder's remote control, answers each line with OK, and keeps the lines. Like LabRecorder, it looks for
/// streams for more than a second before it answers "update" and "start".
class FakeLabRecorder {
 public:
  FakeLabRecorder() : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(listener_, 4), 0);
    EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    port_ = ntohs(address.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  }
  ~FakeLabRecorder() {
    thread_.request_stop();
    thread_.join();
    ::close(listener_);
  }
  /// From now on it answers no line.
  void fall_silent() noexcept { answers_ = false; }
  /// From now on it ends the connection after each line.
  void hang_up() noexcept { hangs_up_ = true; }
  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] std::vector<std::string> lines() {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

 private:
  static bool has_input(int descriptor) {
    pollfd item{.fd = descriptor, .events = POLLIN, .revents = 0};
    return ::poll(&item, 1, 50) > 0;
  }
  void keep(std::string line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(std::move(line));
  }
  void serve(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      if (!has_input(listener_)) continue;
      const int peer = ::accept(listener_, nullptr, nullptr);
      std::string line;
      char letter = 0;
      while (!stop.stop_requested()) {
        if (!has_input(peer)) continue;
        if (::recv(peer, &letter, 1, 0) != 1) break;
        if (letter != '\n') {
          line += letter;
          continue;
        }
        if (hangs_up_) {
          keep(line);
          break;
        }
        const bool is_slow = line == "update" || line == "start";
        keep(std::exchange(line, {}));
        if (is_slow) std::this_thread::sleep_for(std::chrono::milliseconds(1200));
        if (answers_) static_cast<void>(::send(peer, "OK", 2, MSG_NOSIGNAL));
      }
      ::close(peer);
    }
  }

  int listener_;
  int port_ = 0;
  std::atomic<bool> answers_ = true;
  std::atomic<bool> hangs_up_ = false;
  std::mutex mutex_;
  std::vector<std::string> lines_;
  std::jthread thread_;
};

}  // namespace dts::test
