// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dts/error.h"
#include "dts/key.h"
#include "dts/stream.h"

namespace dts::client {

enum class Mode : std::uint8_t {
  All,     ///< Every block in order, as far as the queue reaches; what overflows is counted in `Block::lost_scans`.
  Latest,  ///< After a pause only the newest block of each stream; the skipped scans are counted. Events are all kept.
};

struct SubscriberOptions {
  std::string endpoint;             ///< `Endpoints::data`
  std::vector<std::string> topics;  ///< Prefixes: "floor/cop", "floor/", "" for everything. Byte-wise: "floor" also means "floor2/cop".
  Mode mode = Mode::All;
  int queue_messages = 8192;  ///< Messages kept while the caller does not receive (1..1000000).
  /// Mode Latest after a stall: what was queued on the way is old, and newer data follow behind it. `receive` reads on
  /// until the blocks are as fresh as they used to be, at most this long.
  std::chrono::milliseconds catch_up{100};
  /// Nothing at all for this long, not even the daemon's status: connect anew (at least 10 ms).
  std::chrono::milliseconds reconnect_after{5000};
  std::optional<Key> key;  ///< For a daemon on another machine.
};

/// Counters since `open`.
struct SubscriberStatistics {
  std::uint64_t messages = 0;        ///< Well-formed messages taken from the socket.
  std::uint64_t malformed = 0;       ///< Ignored: not what the protocol allows.
  std::uint64_t unknown_topics = 0;  ///< Ignored: topics that this version or the daemon's status does not know.
  std::uint64_t inconsistent = 0;    ///< Blocks whose position goes backwards; delivered, loss unknown.
  std::uint64_t dropped_events = 0;  ///< Events dropped because the caller did not receive for too long.
  std::uint64_t restarts = 0;        ///< Restarts of the daemon.
};

/// Receives samples, events and status from a daemon.
///
/// Learns the stream formats from the daemon's status first: blocks that arrive earlier wait (bounded). Connects in the
/// background and again after an interruption; a dead peer is noticed by heartbeats within 6 s. Whatever is malformed is
/// counted and ignored.
/// Thread: one at a time.
class Subscriber {
 public:
  /// Fails with InvalidArgument for options that make no sense. A daemon that is not there is not an error: it may come.
  [[nodiscard]] static Result<Subscriber> open(const SubscriberOptions& options);
  ~Subscriber();
  Subscriber(Subscriber&&) noexcept;
  Subscriber& operator=(Subscriber&&) noexcept;
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  /// The next message; nothing when `timeout` (0..1 day) passes first, or when a signal arrives. Status messages are handed out
  /// only if a topic prefix asks for "dtsd/status". What the message points to is valid until the next call.
  /// Call it again and again: the connection is looked after in here. Fails with Internal when the socket breaks.
  [[nodiscard]] Result<std::optional<Message>> receive(std::chrono::milliseconds timeout);

  /// Other topics from now on. What still waits of topics no longer wanted is handed out. Scans missed while a stream was not wanted are
  /// counted as lost when it is wanted again. Fails as `open` does, and with Internal when the socket breaks.
  [[nodiscard]] Result<void> set_topics(const std::vector<std::string>& topics);

  /// The newest status received, or nullptr. Valid until the next `receive`.
  [[nodiscard]] const v1::StatusSnapshot* status() const noexcept;
  [[nodiscard]] const SubscriberStatistics& statistics() const noexcept;

 private:
  class Implementation;
  explicit Subscriber(std::unique_ptr<Implementation> implementation);

  std::unique_ptr<Implementation> implementation_;
};

}  // namespace dts::client
