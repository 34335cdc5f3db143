// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/epoll.h>

#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/clock.h"
#include "core/log.h"
#include "core/result.h"
#include "ipc/data_socket.h"

namespace dts::ipc {

/// DataSocket on a Unix socket that speaks ZMTP 3.0 itself: SUB sockets of every ZeroMQ library connect to it. Nothing here grows with what
/// a peer sends or does not read, and no peer delays another one: that is why libzmq does not serve local subscribers (its version 4.3
/// bounds neither subscriptions nor handshakes, and one peer with 400,000 subscriptions silences all others for seconds).
///
///     send: frames --> queue of each subscriber whose prefix matches        flush: one system call per subscriber with a queue
///     wait, take_subscriptions: new peers, handshakes, subscriptions, PING; subscribers that can be written again
///
/// A message that finds no room in a subscriber's queue is dropped for that subscriber alone. Sequence numbers and scan indices show it the
/// exact loss of blocks; events have no numbers.
class LocalPublisher final : public DataSocket {
 public:
  static constexpr std::size_t kMostPeers = 256;
  static constexpr std::size_t kMostPeersOfAProcess = 64;
  static constexpr std::size_t kMostSubscriptions = 256;  ///< Of one peer. A peer that wants more is disconnected.
  static constexpr std::size_t kLongestPrefix = 200;
  static constexpr std::size_t kQueueBytes = std::size_t{384} << 10U;  ///< Of one peer, besides the kernel's buffer.
  static constexpr std::int64_t kHandshakeNs = 2'000'000'000;

  /// Binds `endpoint` ("ipc:///path"), in the place of a socket file that no program uses any more. Fails with the endpoint and the reason.
  [[nodiscard]] static core::Result<std::unique_ptr<LocalPublisher>> bind(const std::string& endpoint, const core::Clock& clock,
                                                                          core::Log log);
  ~LocalPublisher() override;
  LocalPublisher(const LocalPublisher&) = delete;
  LocalPublisher& operator=(const LocalPublisher&) = delete;

  void send(std::string_view topic, const google::protobuf::MessageLite& message) override;
  [[nodiscard]] bool flush(std::size_t most_peers) override;
  void wait(int bell_fd, int timeout_ms) override;
  [[nodiscard]] bool take_subscriptions() override;
  [[nodiscard]] bool drop_remote_peers() noexcept override { return true; }  // it has none

  /// Lets `wait` end when `fd` is readable too.
  void watch(int fd);
  [[nodiscard]] std::size_t peers() const noexcept { return peers_.size(); }
  /// Returns how many messages found no room in a queue since the start.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  enum class State : std::uint8_t { Greeting, Handshake, Open };
  struct Peer {
    int fd = -1;
    int pid = 0;
    State state = State::Greeting;
    std::int64_t handshake_until_ns = 0;
    std::string in;            ///< An incomplete frame.
    std::string out;           ///< Messages that the kernel has not accepted yet,
    std::size_t written = 0;   ///< apart from so many bytes.
    bool is_blocked = false;   ///< The kernel accepts nothing at the moment; epoll reports when it does.
    bool is_skipping = false;  ///< Within a message of several frames, which no subscriber sends.
    std::set<std::string, std::less<>> prefixes;
    std::unordered_map<std::string, bool> matches;  ///< Of the topics sent so far; empty after each change of `prefixes`.
  };
  enum class Outcome : std::uint8_t { Fine, NewSubscription, Leave };

  LocalPublisher(int listener, int epoll, const core::Clock& clock, core::Log log)
      : listener_(listener), epoll_(epoll), clock_(clock), log_(std::move(log)) {}
  void accept_peers();
  void leave(int fd);
  void leave_late_handshakes();
  void write(Peer& peer);
  void watch_for_room(Peer& peer, bool is_blocked);
  [[nodiscard]] Outcome read(Peer& peer);
  [[nodiscard]] Outcome process(Peer& peer);
  [[nodiscard]] Outcome shake_hands(Peer& peer, std::span<const std::byte>& bytes);
  [[nodiscard]] Outcome obey(Peer& peer, std::span<const std::byte> command);
  [[nodiscard]] Outcome change_subscription(Peer& peer, bool is_new, std::string_view prefix);
  [[nodiscard]] static bool matches(Peer& peer, const std::string& topic);
  static void queue(Peer& peer, std::string_view bytes) { peer.out += bytes; }
  void warn_once(bool& has_warned, const std::string& text);

  int listener_;
  int epoll_;
  const core::Clock& clock_;
  core::Log log_;
  std::map<int, Peer> peers_;  ///< By descriptor.
  std::size_t handshakes_ = 0;
  int bell_fd_ = -1;
  bool is_listening_ = true;
  std::vector<epoll_event> events_;  ///< Of the last `wait`.
  std::string topic_;                ///< Reused, as the next one.
  std::string frames_;
  std::string body_;
  std::uint64_t dropped_ = 0;
  bool has_warned_of_subscriptions_ = false;
  bool has_warned_of_peers_ = false;
};

}  // namespace dts::ipc
