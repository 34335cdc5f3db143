// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "dts/v1/fleet.pb.h"

namespace dts::fleet::forward {

/// Waiting times after failures: 1 s, doubled up to 5 min, each shortened by up to a half at random, so that clinics do not come back all
/// at once. Thread: one.
class Backoff {
 public:
  explicit Backoff(std::uint64_t seed) noexcept : state_(seed) {}

  [[nodiscard]] std::chrono::milliseconds next() noexcept;
  void reset() noexcept { failures_ = 0; }

 private:
  std::uint64_t state_;
  int failures_ = 0;
};

/// Returns another number at each call.
[[nodiscard]] std::uint64_t random_seed();

/// Decides what one upload sends next. Has no clock, no file and no connection: the caller passes times and answers, and does what `next`
/// returns.
///
///     open --> chunks (a window of them without an answer) --> commit --> stored
///      ^           |                                             |
///      '-- no answer for 5 s, or the hub lost what it had -------'
///
/// The window starts with one chunk, and grows with every answer. If no answer arrives, chunks become smaller: a slow link must carry at
/// least one in the time that an answer may take. Thread: one.
class Transfer {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Step {
    enum class Kind { Open, Chunk, Commit, Wait, Ended };
    Kind kind = Kind::Wait;
    std::string worker{};      ///< Of Chunk and Commit.
    std::uint64_t offset = 0;  ///< Of Chunk, as the next.
    std::size_t count = 0;
    Time until{};  ///< Of Wait: when to call again if no answer arrives.
  };
  struct End {
    std::optional<v1::Receipt> receipt{};  ///< The file is safe at the centre.
    std::string refusal{};                 ///< Why the centre does not accept it; empty: it does.
    bool is_damaged = false;               ///< Twice, what arrived was not what was offered: the file may have changed.
  };

  /// `sha256`: 32 bytes. `seed`: of the random part of waiting times.
  Transfer(std::string clinic, std::string sha256, std::uint64_t bytes, std::uint64_t seed);

  /// Returns what to do now. Open, Chunk and Commit count as done when this returns. Answers to what was sent before an Open must not be
  /// passed to `handle` after it: they would look like answers to what comes after. `is_chunk_allowed` false: returns no chunk, because
  /// the limit of the rate is reached.
  [[nodiscard]] Step next(Time now, bool is_chunk_allowed = true);
  /// Handles an answer of the hub, checked by wire::decode_upload_answer.
  void handle(const v1::UploadAnswer& answer, Time now);
  /// Starts again at once: the connection or the hub is new, and what was sent before may be lost.
  void restart() noexcept;
  /// Ends a pause: the hub answers again.
  void retry() noexcept;

  [[nodiscard]] const std::optional<End>& end() const noexcept { return end_; }
  /// Bytes that the hub has.
  [[nodiscard]] std::uint64_t have() const noexcept { return have_; }
  /// Why it waits; empty: it does not wait.
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
  /// Number of times that it began.
  [[nodiscard]] std::uint32_t tries() const noexcept { return tries_; }

 private:
  enum class State { Open, Opening, Sending, Committing, Waiting, Ended };

  struct Sent {
    std::uint64_t end = 0;       ///< Offset after its last byte.
    bool was_overtaken = false;  ///< Sent before it went back: it is sent again, whatever the answer is.
  };

  void handle_upload(const v1::Upload& upload, Time now);
  void handle_receipt(const v1::Receipt& receipt, Time now);
  void wait(std::chrono::milliseconds pause, std::string problem, Time now);
  void go_back(std::uint64_t have) noexcept;

  std::string clinic_;
  std::string sha256_;
  std::uint64_t bytes_;
  Backoff backoff_;
  State state_ = State::Open;
  std::string worker_;
  std::uint64_t have_ = 0;
  std::uint64_t next_ = 0;  ///< Offset of the next chunk.
  std::size_t chunk_;       ///< Bytes of a chunk.
  std::size_t window_ = 1;  ///< Most chunks without an answer.
  std::deque<Sent> sent_;   ///< Chunks without an answer; answers come in this order.
  Time deadline_{};
  std::uint32_t tries_ = 0;
  int damaged_commits_ = 0;
  std::string problem_;
  std::optional<End> end_;
};

}  // namespace dts::fleet::forward
