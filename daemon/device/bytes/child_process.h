// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/descriptor.h"
#include "core/result.h"

namespace dts::device::bytes {

/// A running child process with its standard streams. It is restricted as device/bytes/README.md states.
///
/// Thread: the thread that starts it must live as long as the child: the kernel kills the child when that thread ends.
class ChildProcess {
 public:
  /// Starts `argv`. A program name without '/' is looked up in /usr/local/bin, /usr/bin and /bin. Fails with NotFound, NotAllowed or
  /// Failed.
  [[nodiscard]] static core::Result<ChildProcess> start(const std::vector<std::string>& argv);
  ChildProcess(ChildProcess&&) noexcept = default;

  [[nodiscard]] core::Descriptor take_input() noexcept { return std::move(input_); }    ///< A non-blocking socket: the child's stdin.
  [[nodiscard]] core::Descriptor take_output() noexcept { return std::move(output_); }  ///< A non-blocking pipe: the child's stdout.
  [[nodiscard]] core::Descriptor take_errors() noexcept { return std::move(errors_); }  ///< A non-blocking pipe: the child's stderr.
  /// Returns a new pidfd of the child.
  [[nodiscard]] core::Descriptor watch() const noexcept;

  /// Waits for the end of the child, at most `limit_ms`. Returns true if it has ended; it is then still a zombie.
  [[nodiscard]] bool wait(int limit_ms) const noexcept;
  /// Returns how the child ended: "ended with exit status 3", "was killed by signal 9 (Killed)"; empty if it runs. Does not reap.
  [[nodiscard]] std::string end_text() const;
  /// Asks the child and its group to end (SIGTERM), then kills them and everything that carries the child's mark in its environment.
  /// Returns within 250 ms, true if the child was reaped; false if the kernel has not ended it yet: call it again later.
  bool end() noexcept;

 private:
  ChildProcess(pid_t child, std::string mark, core::Descriptor pidfd, core::Descriptor input, core::Descriptor output,
               core::Descriptor errors) noexcept
      : child_(child),
        mark_(std::move(mark)),
        pidfd_(std::move(pidfd)),
        input_(std::move(input)),
        output_(std::move(output)),
        errors_(std::move(errors)) {}

  pid_t child_;
  std::string mark_;  ///< Its entry of the environment that no other process has.
  core::Descriptor pidfd_;
  core::Descriptor input_;
  core::Descriptor output_;
  core::Descriptor errors_;
  bool is_reaped_ = false;
};

}  // namespace dts::device::bytes
