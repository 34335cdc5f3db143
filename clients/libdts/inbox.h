// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "dts/subscriber.h"
#include "loss_tracker.h"
#include "topic_name.h"

namespace dts::client {

/// The subscriber without its socket: decodes messages, delivers them in order or keeps only the newest block, and counts missing scans.
/// Has no clock: the caller passes the time.
///
///     accept --decode--> block --format known?--> [ready] --next--> caller
///                                 | no: mode All    --> [held]  replayed when the status arrives
///                                 |     mode Latest --> stays in its topic, overwritten by newer ones
class Inbox {
 public:
  /// `boot_id`: of this host. Block ages are valid only if the daemon's status has the same one.
  Inbox(Mode mode, bool hands_out_status, std::string boot_id);

  void hand_out_status(bool is_wanted) noexcept { hands_out_status_ = is_wanted; }

  /// Processes one message from the wire. In mode All, call `next` until it returns nothing before the next call.
  void accept(std::string_view topic, std::span<const std::byte> body, std::int64_t now_ns);
  /// Returns the next message for the caller; its views are valid until the next `accept` or `next`.
  [[nodiscard]] std::optional<Message> next(std::int64_t now_ns);

  /// In mode Latest, returns true if a waiting block is much older than blocks of its stream usually are on arrival. Newer blocks are then
  /// still on their way.
  [[nodiscard]] bool is_behind() const noexcept;
  /// Makes the present delays the usual ones: newer blocks did not arrive, or not in time.
  void accept_delays() noexcept;

  [[nodiscard]] const v1::StatusSnapshot* status() const noexcept { return has_status_ ? &status_ : nullptr; }
  [[nodiscard]] const SubscriberStatistics& statistics() const noexcept { return statistics_; }
  /// Counts a message that the socket layer found malformed.
  void count_malformed() noexcept { ++statistics_.malformed; }
  void note_interruptions(std::uint64_t count) noexcept { statistics_.interruptions = count; }

 private:
  struct Topic {
    std::string text;
    TopicName name;  ///< Views into `text`.
    const StreamFormat* format = nullptr;
    v1::StreamBlock block;
    bool is_pending = false;  ///< The reader has not received `block` yet.
    bool is_queued = false;   ///< `ready_` has an entry for `block`.
    LossTracker tracker;
    std::uint64_t lost_scans = 0;
    bool is_lost_exact = true;
    std::int64_t delay_ns = 0;                   ///< Time from the newest scan of `block` to its arrival.
    std::optional<std::int64_t> usual_delay_ns;  ///< The smallest so far.
    std::string last_retained;                   ///< Wire bytes of the last retained event, to recognise a repeat.

    void forget();  ///< Clears everything that belongs to an earlier run of the daemon.
  };
  struct Held {
    Topic* topic;
    std::string body;
    std::int64_t arrived_ns;
  };
  struct ReadyEvent {
    Topic* topic;
    v1::Event event;
  };
  struct ReadyStatus {};
  using Ready = std::variant<Topic*, ReadyEvent, ReadyStatus, Restart>;

  [[nodiscard]] Topic* find_topic(std::string_view topic);
  void process(Topic& topic, std::span<const std::byte> body, std::int64_t arrived_ns);
  void accept_status(std::span<const std::byte> body);
  void accept_event(Topic& topic, std::span<const std::byte> body);
  void accept_block(Topic& topic, std::span<const std::byte> body, std::int64_t arrived_ns);
  [[nodiscard]] bool has_format(Topic& topic, const v1::StreamBlock& block);
  void take_block(Topic& topic, std::int64_t arrived_ns);
  void count_gap(Topic& topic, const v1::StreamBlock& block);
  void hold(Topic& topic, std::span<const std::byte> body, std::int64_t arrived_ns);
  void drop_oldest_held();
  void replay_held();
  void note_instance(std::uint64_t instance_id);
  void learn_formats();
  void enqueue_pending();
  void enqueue_event(Topic& topic, v1::Event&& event);
  [[nodiscard]] static bool is_late(const Ready& item) noexcept;
  [[nodiscard]] Block block_view(Topic& topic, std::int64_t now_ns);

  Mode mode_;
  bool hands_out_status_;
  std::string boot_id_;
  std::map<std::string, Topic, std::less<>> topics_;
  std::map<std::string, StreamFormat, std::less<>> formats_;  ///< By topic, of the present run of the daemon.
  bool knows_formats_ = false;
  bool has_status_ = false;
  bool is_same_host_ = false;
  std::uint64_t instance_id_ = 0;
  v1::StatusSnapshot status_;
  v1::StreamBlock scratch_;  ///< Decoded here first, so that a malformed message does not destroy the block in its topic.
  std::deque<Ready> ready_;
  Ready current_;  ///< The item that the caller's view points to.
  std::deque<Held> held_;
  std::size_t held_bytes_ = 0;
  SubscriberStatistics statistics_;
};

}  // namespace dts::client
