// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dts/error.h"
#include "dts/export.h"
#include "dts/key.h"
#include "dts/stream.h"

namespace dts::client {

/// What `Subscriber::receive` returns after the caller was slow.
enum class Mode : std::uint8_t {
  /// Every block in order, as long as the queue has room; `Block::lost_scans` counts the dropped scans.
  All,
  /// After a pause only the newest block of each stream; the skipped scans are counted. Events are kept, but if 4096 messages wait, the
  /// oldest event is dropped: `SubscriberStatistics::dropped_events`.
  Latest,
};

/// Options of `Subscriber::open`.
struct SubscriberOptions {
  std::string endpoint;             ///< `Endpoints::data`
  std::vector<std::string> topics;  ///< Prefixes: "floor/cop", "floor/", "" for all. Byte-wise: "floor" also matches "floor2/cop".
  Mode mode = Mode::All;            ///< What `receive` returns after the caller was slow.
  /// Messages kept while the caller does not call `receive` (1..1000000). Only for a daemon on another machine. A local daemon keeps
  /// 384 kB for each subscriber, besides the buffer of the kernel.
  int queue_messages = 8192;
  /// For mode Latest after a stall: the queued blocks are old, and newer ones follow. `receive` reads on until the blocks are as fresh as
  /// before the stall, but no longer than this.
  std::chrono::milliseconds catch_up{100};
  /// Connects again if no message arrives for this long, not even the daemon's status (at least 10 ms).
  std::chrono::milliseconds reconnect_after{5000};
  std::optional<Key> key;  ///< For a daemon on another machine.
};

/// Counters since `open`.
struct SubscriberStatistics {
  std::uint64_t messages = 0;        ///< Valid messages received from the socket.
  std::uint64_t malformed = 0;       ///< Ignored: messages that the protocol does not allow.
  std::uint64_t unknown_topics = 0;  ///< Ignored: topics that neither this version nor the daemon's status knows.
  std::uint64_t inconsistent = 0;    ///< Blocks whose position goes backwards. They are delivered; their loss is unknown.
  std::uint64_t dropped_events = 0;  ///< Events dropped because the caller did not call `receive` for too long.
  std::uint64_t restarts = 0;        ///< Restarts of the daemon.
  /// Connections to a local daemon that the daemon ended. Events may be missing where that happened, and only there: the daemon ends the
  /// connection of a subscriber that read too slowly for an event. Blocks show their own loss.
  std::uint64_t interruptions = 0;
};

/// Receives samples, events and status from a daemon.
///
/// Reads the stream formats from the daemon's status first; blocks that arrive earlier wait in a bounded queue. Connects in the background,
/// and connects again after an interruption, or if `receive` waited for `reconnect_after` and nothing arrived. Malformed messages are
/// counted and ignored. Thread: one at a time.
class DTS_API Subscriber {
 public:
  /// Subscribes to the topics. Fails with InvalidArgument for invalid options. A daemon that does not run yet is not an error: it may start
  /// later, and is connected in the background. If a local daemon runs, the subscriptions are sent before this returns; the daemon serves
  /// them some milliseconds later.
  [[nodiscard]] static Result<Subscriber> open(const SubscriberOptions& options);
  ~Subscriber();
  /// Moves. The source can then only be destroyed or assigned to.
  Subscriber(Subscriber&&) noexcept;
  /// Moves. The source can then only be destroyed or assigned to.
  Subscriber& operator=(Subscriber&&) noexcept;
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  /// Returns the next message, or nothing if `timeout` (0..1 day) passes or a signal arrives first. Status messages are returned only if a
  /// topic prefix matches "dtsd/status". Everything that the message points to is valid until the next call. Call this function repeatedly:
  /// it also maintains the connection. Fails with Internal if the socket fails.
  [[nodiscard]] Result<std::optional<Message>> receive(std::chrono::milliseconds timeout);

  /// Replaces the topic prefixes. Messages that already wait for a removed topic are still returned. Scans missed while a stream was not
  /// subscribed count as lost when it is subscribed again. Fails as `open` does, and with Internal if the socket fails.
  [[nodiscard]] Result<void> set_topics(const std::vector<std::string>& topics);

  /// Returns the newest status received, or nullptr. Valid until the next `receive`.
  [[nodiscard]] const v1::StatusSnapshot* status() const noexcept;
  /// Returns the counters since `open`. Valid as long as this subscriber exists.
  [[nodiscard]] const SubscriberStatistics& statistics() const noexcept;

 private:
  class Implementation;
  explicit Subscriber(std::unique_ptr<Implementation> implementation);

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace dts::client
