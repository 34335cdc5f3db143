// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

/// ZMTP 3.0, the protocol of ZeroMQ on a byte stream (rfc.zeromq.org/spec/23), with the mechanism NULL: greetings, frames, commands. Knows
/// nothing of sockets: bytes in, frames out. Every length is checked against a limit before memory is reserved.
///
///     peer A: greeting (64 bytes), command READY            subscriber: messages 01 + topic prefix, 00 + topic prefix
///     peer B: greeting (64 bytes), command READY            publisher: messages of several frames; either may send PING
namespace dts::zmtp {

inline constexpr std::size_t kGreetingBytes = 64;

/// The greeting of version 3.0: peers of version 3.1 then send subscriptions as messages, as every libzmq since 4.0 understands.
[[nodiscard]] std::string greeting();
/// Returns why a complete greeting cannot be accepted; empty: it can. `bytes` may be shorter than a greeting: then only what is there is
/// checked.
[[nodiscard]] std::string_view fault_of_greeting(std::span<const std::byte> bytes) noexcept;

/// A frame within a buffer.
struct Frame {
  bool is_command = false;
  bool has_more = false;            ///< Another frame of the same message follows.
  std::span<const std::byte> body;  ///< Valid as long as the buffer.
  std::size_t size = 0;             ///< Of the whole frame, header included.
};
/// The frame at the start of `bytes`; nothing if it is incomplete; a text if the bytes are no frame or its body is longer than `limit`.
using FrameResult = std::variant<std::optional<Frame>, std::string_view>;
[[nodiscard]] FrameResult next_frame(std::span<const std::byte> bytes, std::size_t limit) noexcept;

void append_frame(std::string& out, std::string_view body, bool has_more = false);
void append_command(std::string& out, std::string_view name, std::string_view data);

/// The command READY with which a peer says what it is: "SUB", "XPUB".
void append_ready(std::string& out, std::string_view socket_type);
struct Command {
  std::string_view name;
  std::string_view data;
};
/// Splits the body of a command frame; nothing if it has no name.
[[nodiscard]] std::optional<Command> command_of(std::span<const std::byte> body) noexcept;
/// Returns the value of a property of READY, whose names ignore upper and lower case; nothing if it is absent or the data are malformed.
[[nodiscard]] std::optional<std::string_view> property_of(std::string_view ready_data, std::string_view name) noexcept;
/// Answers PING: a command PONG with the context of the ping. No effect if the ping is malformed.
void append_pong(std::string& out, std::string_view ping_data);

}  // namespace dts::zmtp
