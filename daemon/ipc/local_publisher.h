// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/epoll.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/clock.h"
#include "core/doorbell.h"
#include "core/log.h"
#include "core/result.h"
#include "ipc/data_socket.h"
#include "ipc/send_queue.h"

namespace dts::ipc {

/// DataSocket on a Unix socket that speaks ZMTP 3.0 itself: SUB sockets of every ZeroMQ library connect to it. Nothing here grows with what
/// a peer sends or does not read, and no peer delays another one: that is why libzmq does not serve local subscribers (its version 4.3
/// bounds neither subscriptions nor handshakes, and one peer with 400,000 subscriptions silences all others for seconds).
///
///     send: frames --> queue of each subscriber of the topic         flush: one system call per subscriber with a queue
///     wait, take_subscriptions: new peers, handshakes, subscriptions, PING; subscribers that can be written again
///
/// A message that finds no room in a subscriber's queue is dropped for that subscriber alone. Sequence numbers and scan indices show it the
/// exact loss of blocks. Events have no numbers; therefore no event is missing within a connection: blocks leave room for events, and if
/// even that is full, the connection ends behind what is queued.
///
/// Memory: `send` and `flush` allocate nothing after the first message of a topic, and use only what they need for it: `wait` may run at
/// the same time. A subscriber has a small queue. If the kernel's buffer is full, `take_subscriptions` reserves a large one until the
/// subscriber has read everything.
class LocalPublisher final : public DataSocket {
 public:
  static constexpr std::size_t kMostPeers = 256;
  static constexpr std::size_t kMostPeersOfAProcess = 64;
  static constexpr std::size_t kMostSubscriptions = 256;  ///< Of one peer. A peer that wants more is disconnected.
  static constexpr std::size_t kLongestPrefix = 200;
  static constexpr std::size_t kSmallQueueBytes = std::size_t{9} << 10U;  ///< Of one peer, besides the kernel's buffer,
  static constexpr std::size_t kQueueBytes = std::size_t{352} << 10U;     ///< and while that buffer is full.
  static constexpr std::size_t kMostLargeQueues = 16;
  static constexpr std::size_t kMostLargeQueuesOfAProcess = 4;
  /// Time limit of the handshake. If no connection is free, a newcomer replaces one that has no subscription after this time.
  static constexpr std::int64_t kHandshakeNs = 2'000'000'000;
  /// If dtsd has no free descriptor for a newcomer, it accepts nobody for this time.
  static constexpr std::int64_t kAcceptPauseNs = 1'000'000'000;

  /// Binds `endpoint` ("ipc:///path"), in the place of a socket file that no program uses any more. Fails with the endpoint and the reason.
  [[nodiscard]] static core::Result<std::unique_ptr<LocalPublisher>> bind(const std::string& endpoint, const core::Clock& clock,
                                                                          core::Log log);
  ~LocalPublisher() override;
  LocalPublisher(const LocalPublisher&) = delete;
  LocalPublisher& operator=(const LocalPublisher&) = delete;

  [[nodiscard]] bool is_wanted(std::string_view topic) override { return !subscribers_of(topic).empty(); }
  void send(std::string_view topic, const google::protobuf::MessageLite& message) override;
  [[nodiscard]] bool flush(std::size_t most_peers) override;
  void wait(int bell_fd, int timeout_ms) override;
  [[nodiscard]] bool take_subscriptions() override;

  /// Prepares for messages of `topic`, so that already the first one finds its subscribers without memory.
  void expect(std::string_view topic) override;
  [[nodiscard]] std::size_t peers() const noexcept { return peers_.size(); }
  /// Returns how many messages found no room in a queue since the start.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  enum class State : std::uint8_t { Greeting, Handshake, Open };
  struct Peer {
    int fd = -1;
    int pid = 0;
    State state = State::Greeting;
    std::int64_t connected_ns = 0;
    std::string in;             ///< An incomplete frame.
    SendQueue out;              ///< What the kernel has not accepted yet.
    bool is_blocked = false;    ///< The kernel accepts nothing at the moment; epoll reports when it does.
    bool misses_event = false;  ///< Gets nothing more: its connection ends behind `out`.
    bool is_skipping = false;   ///< Within a message of several frames, which no subscriber sends.
    std::set<std::string, std::less<>> prefixes;
    bool is_matched = true;  ///< `topics_` knows the present prefixes.
  };
  using Subscribers = std::vector<Peer*>;
  enum class Outcome : std::uint8_t { Fine, NewSubscription, Leave };

  LocalPublisher(int listener, int epoll, const core::Clock& clock, core::Log log)
      : listener_(listener), epoll_(epoll), clock_(clock), log_(std::move(log)) {
    frames_.reserve(2 * kSmallQueueBytes);
    body_.reserve(2 * kSmallQueueBytes);
  }
  void watch(int fd);
  void accept_peers();
  void pause_listening();
  void listen_again();
  void accept(int fd);
  [[nodiscard]] bool make_room_for(int pid);
  [[nodiscard]] std::optional<int> replaceable(std::size_t of_newcomer) const;
  void handle(const epoll_event& event, bool& has_new_subscription);
  void leave(int fd);
  void leave_late_handshakes();
  void write(Peer& peer);
  void resize_queue(Peer& peer);
  void watch_for_room(Peer& peer, bool is_blocked);
  [[nodiscard]] Outcome read(Peer& peer);
  [[nodiscard]] Outcome process(Peer& peer);
  [[nodiscard]] Outcome shake_hands(Peer& peer, std::span<const std::byte>& bytes);
  [[nodiscard]] Outcome obey(Peer& peer, std::span<const std::byte> command);
  [[nodiscard]] Outcome change_subscription(Peer& peer, bool is_new, std::string_view prefix);
  void match(Peer& peer);
  [[nodiscard]] static bool matches(const Peer& peer, std::string_view topic);
  [[nodiscard]] Subscribers& subscribers_of(std::string_view topic);
  [[nodiscard]] bool encode(std::string_view topic, const google::protobuf::MessageLite& message);
  void offer(Peer& peer, bool is_event);
  [[nodiscard]] bool send_directly(Peer& peer);
  void warn_once(bool& has_warned, const std::string& text);

  int listener_;
  int epoll_;
  const core::Clock& clock_;
  core::Log log_;
  std::map<int, Peer> peers_;                               ///< By descriptor.
  std::map<std::string, Subscribers, std::less<>> topics_;  ///< Bounded: the daemon has some dozens.
  std::size_t handshakes_ = 0;
  core::Doorbell blocked_;  ///< Rung by `send` and `flush` for a subscriber that needs a large queue.
  int bell_fd_ = -1;        ///< This and the events are of `wait` alone, until `take_subscriptions` looks at the events.
  std::array<epoll_event, 16> events_{};
  std::size_t event_count_ = 0;
  std::optional<std::int64_t> listens_again_ns_;  ///< Nothing: it listens.
  std::string frames_;                            ///< Reused, as the next one.
  std::string body_;
  std::uint64_t dropped_ = 0;
  bool has_warned_of_subscriptions_ = false;
  bool has_warned_of_peers_ = false;
  bool has_warned_of_events_ = false;
  bool has_warned_of_descriptors_ = false;
};

}  // namespace dts::ipc
