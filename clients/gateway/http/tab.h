// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace dts::gateway {

/// The WebSocket of one browser tab, from its Tab's point of view. Thread: io.
class TabConnection {
 public:
  virtual ~TabConnection() = default;
  /// Queues one binary message.
  virtual void send(std::string message) = 0;
  /// Returns the bytes that are queued and not yet passed to the kernel.
  [[nodiscard]] virtual std::size_t unsent_bytes() const noexcept = 0;
  /// Ends the connection with a WebSocket close code and a reason (at most 120 bytes). The Tab is destroyed later, not during this call.
  virtual void close(unsigned code, std::string reason) = 0;
};

/// The gateway's side of one tab. Owned by its connection, which outlives it. Thread: io.
class Tab {
 public:
  virtual ~Tab() = default;
  /// Handles one whole binary message from the browser, within the size limit. Text messages are never passed on.
  virtual void on_message(std::string_view message) = 0;
};

}  // namespace dts::gateway
