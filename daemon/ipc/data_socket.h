// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message_lite.h>

#include <cstddef>
#include <string_view>

namespace dts::ipc {

/// The sending end of the data bus, as a SUB socket of ZeroMQ sees it. Thread: `wait` only the publish thread; the others one at a time.
class DataSocket {
 public:
  virtual ~DataSocket() = default;

  /// Returns false if nobody would get a message of `topic`: then it need not be made.
  [[nodiscard]] virtual bool is_wanted(std::string_view /*topic*/) { return true; }
  /// Sends one message to every subscriber of a prefix of `topic`, at the latest at the next `flush`. Never blocks: drops the message for a
  /// subscriber whose queue is full, and that subscriber sees a dropped block in the sequence numbers.
  virtual void send(std::string_view topic, const google::protobuf::MessageLite& message) = 0;
  /// Gives the messages to the system for at most `most_peers` subscribers. Returns false if it left out others.
  [[nodiscard]] virtual bool flush(std::size_t most_peers) {
    static_cast<void>(most_peers);
    return true;
  }
  /// Prepares for messages of `topic` before the first one is sent.
  virtual void expect(std::string_view /*topic*/) {}
  /// Sleeps until the descriptor `bell_fd` is readable, a subscriber's message arrives, or the timeout ends.
  virtual void wait(int bell_fd, int timeout_ms) = 0;
  /// Handles a bounded number of subscribers' messages if the last `wait` saw any. Returns true if there was a new subscription.
  [[nodiscard]] virtual bool take_subscriptions() = 0;
};

}  // namespace dts::ipc
