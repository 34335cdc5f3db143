// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::device::bytes {

/// What a call of `ByteLink::read` has found.
enum class ReadEnd : std::uint8_t {
  Bytes,        ///< 1 or more bytes.
  Timeout,      ///< No byte by the deadline; the link is up.
  Interrupted,  ///< `interrupt` was called since the last read.
  Lost,         ///< The other end is gone: unplugged, connection closed, child ended. See `why_lost`.
};

struct BytesRead {
  ReadEnd end = ReadEnd::Timeout;
  std::size_t count = 0;    ///< Bytes at the beginning of the caller's buffer.
  std::int64_t raw_ns = 0;  ///< Clock::raw_ns when these bytes were found waiting.
};

/// A stream of bytes in both directions to one board or program. Closed -> open -> Open -> (Lost) -> close -> Closed.
/// Thread: open, close, has_arrived on the owner; read on one thread between open and close; write on the owner, or on the thread that
/// reads as long as the owner does not write; interrupt, facts, why_lost on any.
class ByteLink {
 public:
  virtual ~ByteLink() = default;

  /// Finds the other end and connects. Fails with NotFound if it does not exist, with NotAllowed if the system forbids access (the hint
  /// names the group), with WrongState if another program uses it, and with Failed otherwise. Discards what arrived before.
  /// A tty is then in raw 8N1 mode without modem control, and HUPCL is off if possible.
  [[nodiscard]] virtual core::Status open() = 0;
  /// Disconnects; discards what was not sent yet. A child process has ended (asked, then killed) when this returns, within 500 ms, of
  /// which 150 ms are for the text of `why_lost` if nobody has asked for it. No effect if closed.
  virtual void close() noexcept = 0;
  /// Waits for at least one byte until `deadline_ns` (now_ns clock); does not wait if it has passed. Realtime-safe: no allocation, lock,
  /// log.
  [[nodiscard]] virtual BytesRead read(std::span<std::uint8_t> buffer, std::int64_t deadline_ns) noexcept = 0;
  /// Writes all bytes; may wait for 100 ms, and allocates if it fails. Fails with Timeout if the other end does not take them within 100
  /// ms, with DeviceGone if the link is lost.
  [[nodiscard]] virtual core::Status write(std::span<const std::uint8_t> bytes) = 0;
  /// Makes a waiting read return Interrupted, also one that begins later (once).
  virtual void interrupt() noexcept = 0;
  /// Returns true if the other end (re)appeared since the last call: the caller should retry `open`.
  [[nodiscard]] virtual bool has_arrived() noexcept = 0;

  /// Facts about the open link.
  struct Facts {
    std::vector<std::string> nodes;  ///< Device files: "/dev/ttyACM0"; empty if none.
    std::string serial;              ///< USB serial number of the adapter; may be empty.
  };
  [[nodiscard]] virtual Facts facts() const = 0;
  /// Returns why the link was lost, for a message: "the program ended with exit status 3; its last words: ..."; empty if it was not lost.
  [[nodiscard]] virtual std::string why_lost() const = 0;
  /// Returns true if opening resets the board or starts the program (dtsd then waits up to 5 s for the first answer).
  [[nodiscard]] virtual bool restarts_the_board() const noexcept = 0;
};

}  // namespace dts::device::bytes
