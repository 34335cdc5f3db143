// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"
#include "fleet/link/link.h"

/// The client's half of the protocol of NATS: lines that end with CR LF, and messages with a length in front.
/// https://docs.nats.io/reference/reference-protocols/nats-protocol
namespace dts::fleet::link {

inline constexpr std::size_t kLargestLine = 64 * 1024;  ///< INFO lists all servers of a cluster.
inline constexpr std::size_t kLargestMessage = 8 * 1024 * 1024;
inline constexpr std::string_view kPing = "PING\r\n";
inline constexpr std::string_view kPong = "PONG\r\n";

/// What the server says about itself when a connection begins.
struct ServerInfo {
  std::string nonce{};  ///< To be signed with the key; empty: the server has no keys.
  std::size_t max_payload = 0;
};
/// Reads the JSON of INFO. Fails with DataDamaged.
[[nodiscard]] core::Result<ServerInfo> info_of_json(std::string_view json);

/// One operation of the server.
struct Operation {
  enum class Kind : std::uint8_t { Info, Message, Ping, Pong, Error, Ok };
  Kind kind = Kind::Ok;
  std::uint64_t subscription = 0;  ///< Of Message.
  Letter letter{};                 ///< Of Message.
  std::string text{};              ///< JSON of Info; reason of Error.
};

/// Cuts the bytes of the server into operations. Thread: one.
class Parser {
 public:
  void append(std::string_view bytes) { buffer_.append(bytes); }
  /// Returns nothing if the next operation is not complete. Fails with DataDamaged if the bytes are none; the connection must end then.
  [[nodiscard]] core::Result<std::optional<Operation>> next();
  /// True if no byte waits.
  [[nodiscard]] bool is_empty() const noexcept { return begin_ == buffer_.size(); }

 private:
  std::string buffer_;
  std::size_t begin_ = 0;  ///< Of the next operation in `buffer_`.
};

/// `seed` empty: without a key. Fails with InvalidArgument if it is not a seed.
[[nodiscard]] core::Result<std::string> connect_line(const std::string& name, const std::string& seed, const std::string& nonce,
                                                     bool is_tls);
[[nodiscard]] std::string subscribe_line(const std::string& subject, const std::string& queue, std::uint64_t subscription);
[[nodiscard]] std::string unsubscribe_line(std::uint64_t subscription);
/// Appends a message. Subject and reply were checked with `is_subject`.
void append_publish(const Letter& letter, std::string& out);
/// Returns true for a text that can stand in a line: not empty, without blanks and control characters, at most 1024 bytes.
[[nodiscard]] bool is_subject(std::string_view text) noexcept;

}  // namespace dts::fleet::link
