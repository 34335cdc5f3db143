// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::app {

/// Where sockets live: $DTSD_RUNTIME_DIR, else systemd's $RUNTIME_DIRECTORY, else $XDG_RUNTIME_DIR/dtsd, else
/// /tmp/dtsd-<uid>. Clients follow the same rule.
[[nodiscard]] std::string runtime_directory();

/// Makes `path` (mode 0750) if need be and checks that it belongs to us, that others cannot write into it, and that we can.
/// Fails with NotAllowed or Failed, naming the path and what to do.
[[nodiscard]] core::Status prepare_directory(const std::string& path);

/// Holds a lock on "<runtime directory>/dtsd.lock" while it lives, so that two daemons cannot share one directory.
class RuntimeLock {
 public:
  /// WrongState when another dtsd holds it.
  [[nodiscard]] static core::Result<RuntimeLock> take(const std::string& directory);
  RuntimeLock(RuntimeLock&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  RuntimeLock& operator=(RuntimeLock&&) = delete;
  RuntimeLock(const RuntimeLock&) = delete;
  RuntimeLock& operator=(const RuntimeLock&) = delete;
  ~RuntimeLock();

 private:
  explicit RuntimeLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace dts::app
