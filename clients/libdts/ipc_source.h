// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <map>
#include <vector>

#include "data_source.h"
#include "dts/zmtp/zmtp.h"

namespace dts::client {

/// Reads the local data socket of a daemon, without libzmq: no thread between socket and caller, and one system call per wait.
///
///     Away --connect--> Greeting --64 bytes--> Handshake --READY--> Open     any fault or a closed peer: Away, and connect again later
///
/// While the caller does not call `take` or `wait`, messages wait in the kernel's buffer and then in the daemon, which drops what exceeds
/// the queue of this subscriber. Memory is bounded by two frames of the largest message, and 64 KiB to send.
class IpcSource final : public DataSource {
 public:
  [[nodiscard]] static Result<std::unique_ptr<IpcSource>> open(const SourceOptions& options);
  ~IpcSource() override { close(); }

  void subscribe(const std::string& prefix) override;
  void unsubscribe(const std::string& prefix) override;
  [[nodiscard]] std::optional<RawMessage> take() override;
  [[nodiscard]] Waited wait(std::chrono::milliseconds timeout) override;
  [[nodiscard]] std::uint64_t interruptions() const noexcept override { return interruptions_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class State : std::uint8_t { Away, Greeting, Handshake, Open };

  IpcSource(const sockaddr_un& address, socklen_t address_bytes, std::size_t largest_message)
      : address_(address), address_bytes_(address_bytes), largest_message_(largest_message) {}

  void connect_if_due(std::chrono::milliseconds handshake_limit);
  void wait_until_open(std::chrono::milliseconds limit);
  void close() noexcept;
  void go_away(bool is_fault);
  [[nodiscard]] std::span<const std::byte> unread() const noexcept { return std::span(buffer_).subspan(begin_, end_ - begin_); }
  void make_room();
  [[nodiscard]] bool accept(ssize_t received);
  [[nodiscard]] bool read(int flags);
  [[nodiscard]] bool shake_hands();
  void obey(std::span<const std::byte> command);
  [[nodiscard]] std::optional<RawMessage> parse();
  void send_pending();
  [[nodiscard]] Waited wait_away(std::chrono::milliseconds timeout);
  [[nodiscard]] Waited wait_for_both(std::chrono::milliseconds timeout) const;

  sockaddr_un address_;
  socklen_t address_bytes_;
  std::size_t largest_message_;
  std::map<std::string, int> subscriptions_;  ///< Prefixes, and how often each was added.

  int socket_ = -1;
  State state_ = State::Away;
  Clock::time_point opened_at_{};
  Clock::time_point retry_at_{};
  std::chrono::milliseconds retry_after_ = kFirstReconnect;
  std::chrono::milliseconds receive_timeout_{-1};  ///< As set at the socket.
  std::string pending_;                            ///< Not yet accepted by the kernel.
  std::vector<std::byte> buffer_;
  std::size_t begin_ = 0;     ///< Of the bytes that were not processed yet,
  std::size_t end_ = 0;       ///< and their end.
  std::size_t taken_ = 0;     ///< Bytes of the message that `take` returned: they stay valid until the next call.
  bool is_drained_ = false;   ///< The last read left nothing in the kernel.
  bool is_skipping_ = false;  ///< Within a message of too many frames.
  std::uint64_t interruptions_ = 0;
  bool has_fault_ = false;  ///< To be reported as one malformed message.
};

}  // namespace dts::client
