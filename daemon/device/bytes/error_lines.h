// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "core/descriptor.h"
#include "core/doorbell.h"
#include "core/log.h"
#include "core/token_bucket.h"

namespace dts::device::bytes {

/// Reads the stderr of a program on a thread of its own, so that the program never waits for it: logs a limited number of lines and keeps
/// the newest. A line is at most 200 bytes, printable; the rest of a longer one is dropped.
class ErrorLines {
 public:
  /// `errors`: non-blocking. `name`: the program, for the log.
  ErrorLines(core::Descriptor errors, std::string name, core::Log log);
  ~ErrorLines();  ///< Ends the thread, also while a process holds the other end open.
  ErrorLines(const ErrorLines&) = delete;
  ErrorLines& operator=(const ErrorLines&) = delete;

  /// Returns the newest lines, joined by " | ". Waits up to `limit` for the end of the stream, so that a dying program's words are among
  /// them. Thread: any.
  [[nodiscard]] std::string last_lines(std::chrono::milliseconds limit);

 private:
  void read_all();
  void add(std::string_view bytes);
  void end_line();

  core::Descriptor errors_;
  std::string name_;
  core::Log log_;
  core::Doorbell stop_;
  core::TokenBucket allowance_;
  std::string line_;  ///< The line that is being read.
  std::uint64_t unlogged_ = 0;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::deque<std::string> lines_;
  bool has_ended_ = false;
  std::thread thread_;  ///< Last: it uses all others.
};

}  // namespace dts::device::bytes
