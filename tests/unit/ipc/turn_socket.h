// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <semaphore>
#include <string>
#include <string_view>
#include <utility>

#include "dts/v1/control.pb.h"
#include "dts/v1/stream.pb.h"
#include "ipc/data_socket.h"

namespace dts::ipc {

/// Writes down what is sent, and lets the publish thread take one turn at a time.
class TurnSocket final : public DataSocket {
 public:
  void send(std::string_view topic, const google::protobuf::MessageLite& message) override {
    sent_.append(topic);
    if (const auto* status = dynamic_cast<const v1::StatusSnapshot*>(&message)) sent_ += "=" + status->version();
    if (const auto* event = dynamic_cast<const v1::Event*>(&message)) {
      if (!event->session().label().empty()) sent_ += "=" + event->session().label();
      if (event->has_marker()) sent_ += "=" + event->marker().text();
    }
    sent_ += ' ';
  }
  void wait(int /*bell_fd*/, int timeout_ms) override {
    timeout_ms_ = timeout_ms;
    if (is_over_) return;
    waits_.release();
    turns_.acquire();
  }
  bool take_subscriptions() override { return std::exchange(has_new_, false); }

  /// Returns what was sent in one turn of the loop.
  std::string turn(bool has_new_subscriber = false) {
    waits_.acquire();
    has_new_ = has_new_subscriber;
    sent_.clear();
    turns_.release();
    waits_.acquire();
    waits_.release();
    return sent_;
  }
  /// Turns need nobody from now on: before the publish thread is stopped.
  void end() {
    is_over_ = true;
    turns_.release();
  }

  std::string sent_;
  int timeout_ms_ = 0;

 private:
  std::atomic<bool> is_over_{false};
  bool has_new_ = false;
  std::counting_semaphore<> waits_{0};
  std::counting_semaphore<> turns_{0};
};

}  // namespace dts::ipc
