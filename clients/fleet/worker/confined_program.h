// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/result.h"

namespace dts::fleet::worker {

struct Limits {
  std::chrono::seconds time{600};                     ///< Of the clock, and of the processor.
  std::uint64_t memory_bytes = 4ULL << 30U;           ///< Address space.
  std::size_t output_bytes = std::size_t{16} << 20U;  ///< Standard output and error together.
};

struct Ended {
  std::string out;
  std::string talk;  ///< The first 2000 bytes of standard error.
  int status = 0;    ///< Exit status.
};

/// Runs a program that reads a file of somebody we do not trust, and waits for its end. It has no input, no environment and no descriptor
/// of ours, can change no file, start no process, signal or look into no process, open no socket, and ends with this thread. Calls
/// `keeps_on` at least once a second: false ends the program. In whatever way this function returns, the program has ended.
///
/// Fails with NotFound or NotAllowed if it cannot be started, Timeout, LimitExceeded for too much output, Failed if a signal ended it (also
/// for too much memory), WrongState if `keeps_on` ended it. Call it while the process has one thread.
[[nodiscard]] core::Result<Ended> run_confined(const std::string& program, const std::vector<std::string>& words, const Limits& limits,
                                               const std::function<bool()>& keeps_on);

}  // namespace dts::fleet::worker
