// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace dts::gateway {

/// The WebSocket of one browser tab, as its Tab sees it. Thread: io.
class TabConnection {
 public:
  virtual ~TabConnection() = default;
  /// Queues one binary message.
  virtual void send(std::string message) = 0;
  /// What is queued and not yet with the kernel.
  [[nodiscard]] virtual std::size_t unsent_bytes() const noexcept = 0;
  /// Ends the connection with a WebSocket close code and a reason (at most 120 bytes). The Tab is destroyed later, not in here.
  virtual void close(unsigned code, std::string reason) = 0;
};

/// What the gateway does for one tab. Owned by its connection, which outlives it. Thread: io.
class Tab {
 public:
  virtual ~Tab() = default;
  /// One whole binary message of the browser, within the size limit. Text messages never get here.
  virtual void on_message(std::string_view message) = 0;
};

}  // namespace dts::gateway
