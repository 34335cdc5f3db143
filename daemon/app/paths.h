// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::app {

/// Where sockets live: $DTSD_RUNTIME_DIR, else systemd's $RUNTIME_DIRECTORY, else $XDG_RUNTIME_DIR/dtsd, else
/// /tmp/dtsd-<uid>. Clients follow the same rule.
[[nodiscard]] std::string runtime_directory();

/// Where recordings and catalogue live: $DTSD_STATE_DIR, else systemd's $STATE_DIRECTORY, else $XDG_STATE_HOME/dtsd, else
/// ~/.local/state/dtsd, else a folder in the runtime directory.
[[nodiscard]] std::string state_directory();

/// Makes `path` (mode 0750) if need be and checks that it belongs to us, that others cannot write into it, and that we can.
/// Fails with NotAllowed or Failed, naming the path and what to do.
/// `variable` is the environment variable to set to another directory.
[[nodiscard]] core::Status prepare_directory(const std::string& path, const std::string& variable = "DTSD_RUNTIME_DIR");

/// Holds a lock on "<directory>/dtsd.lock" while it lives, so that two daemons cannot share one directory for sockets or recordings.
class DirectoryLock {
 public:
  /// WrongState when another dtsd holds it.
  [[nodiscard]] static core::Result<DirectoryLock> take(const std::string& directory, const std::string& variable = "DTSD_RUNTIME_DIR");
  DirectoryLock(DirectoryLock&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  DirectoryLock& operator=(DirectoryLock&&) = delete;
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;
  ~DirectoryLock();

 private:
  explicit DirectoryLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace dts::app
