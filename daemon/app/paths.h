// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"

namespace dts::app {

/// Creates the folder `path` (mode 0750) if it does not exist. Checks that this user owns it, that this user can write into it, and that
/// others cannot. Fails with NotAllowed or Failed, naming the path and what to do. `variable`: the environment variable for another folder,
/// for the message.
[[nodiscard]] core::Status prepare_directory(const std::string& path, const std::string& variable = "DTSD_RUNTIME_DIR");

/// Holds a lock on "<directory>/dtsd.lock" until it is destroyed, so that two daemons cannot use one folder for sockets or recordings.
class DirectoryLock {
 public:
  /// Locks the folder. Fails with WrongState if another dtsd holds the lock.
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
