// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/message_lite.h>

#include <string_view>

namespace dts::ipc {

/// The sending end of the data bus. libzmq's XPUB is the reference; whatever replaces it speaks the same topics.
/// Thread: publish, all of it.
class DataSocket {
 public:
  virtual ~DataSocket() = default;

  /// Sends one message to whoever subscribes to a prefix of `topic`. Never blocks: a subscriber whose queue is full
  /// misses it, and sees that in the sequence numbers.
  virtual void send(std::string_view topic, const google::protobuf::MessageLite& message) = 0;
  /// Sleeps until the descriptor `bell_fd` is readable, a subscriber has something to say, or the time is over.
  virtual void wait(int bell_fd, int timeout_ms) = 0;
  /// Handles a bounded number of subscribers' messages, if the last `wait` saw any; true when somebody newly subscribed to
  /// something.
  [[nodiscard]] virtual bool take_subscriptions() = 0;
  /// Ends all connections from other machines; those that still may come again at once. False: nobody can, try again.
  [[nodiscard]] virtual bool drop_remote_peers() noexcept = 0;
};

}  // namespace dts::ipc
