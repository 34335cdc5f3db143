// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "dts/error.h"
#include "dts/key.h"

namespace dts::client {

/// A message of the data socket, as it arrived: valid until the next call of the source.
struct RawMessage {
  std::string_view topic;
  std::span<const std::byte> body;
  bool is_well_formed = false;  ///< Two frames; otherwise ignore topic and body.
};

enum class Waited : std::uint8_t { Ready, TimedOut, Interrupted };

/// A subscribing connection to the data socket of a daemon. Connects in the background, and again after an interruption.
/// Thread: one at a time.
class DataSource {
 public:
  DataSource() = default;
  virtual ~DataSource() = default;
  DataSource(const DataSource&) = delete;
  DataSource& operator=(const DataSource&) = delete;

  /// Subscriptions are counted: a prefix that was added twice must be removed twice.
  virtual void subscribe(const std::string& prefix) = 0;
  virtual void unsubscribe(const std::string& prefix) = 0;
  /// Returns the next message that has arrived, without waiting.
  [[nodiscard]] virtual std::optional<RawMessage> take() = 0;
  /// Waits until a message may be there (Ready), for at most `timeout`, or until a signal arrives (Interrupted).
  [[nodiscard]] virtual Waited wait(std::chrono::milliseconds timeout) = 0;
  /// Returns how many open connections have ended. Always 0 if the transport hides that.
  [[nodiscard]] virtual std::uint64_t interruptions() const noexcept { return 0; }
};

inline constexpr std::chrono::milliseconds kFirstReconnect{100};
inline constexpr std::chrono::milliseconds kSlowestReconnect{1000};
/// How long a local source waits for the daemon's answer when it connects.
inline constexpr std::chrono::milliseconds kFirstHandshake{500};
inline constexpr std::chrono::milliseconds kReconnectHandshake{20};

struct SourceOptions {
  std::string endpoint;
  int queue_messages = 0;
  std::size_t largest_message = 0;  ///< A peer that announces more is disconnected.
  std::optional<Key> key;
  std::chrono::milliseconds handshake_limit = kFirstHandshake;
};

/// Opens the source for an endpoint: `ipc://` without libzmq, everything else with it. Fails with InvalidArgument if the endpoint cannot be
/// used.
[[nodiscard]] Result<std::unique_ptr<DataSource>> open_source(const SourceOptions& options);

}  // namespace dts::client
