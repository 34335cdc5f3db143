// SPDX-License-Identifier: Apache-2.0
#include "app/paths.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace dts::app {
namespace {

constexpr mode_t kDirectoryMode = 0750;

}  // namespace

core::Status prepare_directory(const std::string& path, const std::string& variable) {
  const std::string hint = "set " + variable + " to a directory of your own";
  std::error_code error;
  const auto parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) std::filesystem::create_directories(parent, error);
  if (::mkdir(path.c_str(), kDirectoryMode) != 0 && errno != EEXIST) {
    return core::fail_errno(errno, "directory " + path + " cannot be created", hint);
  }
  struct stat found {};
  // lstat, not stat: in /tmp another user could have created a link with this name.
  if (::lstat(path.c_str(), &found) != 0) return core::fail_errno(errno, "directory " + path, hint);
  if (!S_ISDIR(found.st_mode)) return core::fail(core::ErrorCode::Failed, "directory " + path + " is not a directory", hint);
  if (found.st_uid != ::geteuid()) {
    return core::fail(core::ErrorCode::NotAllowed, "directory " + path + " belongs to another user", hint);
  }
  if ((found.st_mode & S_IWOTH) != 0) {
    return core::fail(core::ErrorCode::NotAllowed, "directory " + path + " is writable by every user", "chmod o-rwx " + path);
  }
  if (::access(path.c_str(), W_OK | X_OK) != 0) return core::fail_errno(errno, "directory " + path + " cannot be written", hint);
  return {};
}

core::Result<DirectoryLock> DirectoryLock::take(const std::string& directory, const std::string& variable) {
  const std::string path = directory + "/dtsd.lock";
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0) return core::fail_errno(errno, "lock file " + path, "set " + variable + " to a directory of your own");
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd);
    return core::fail(core::ErrorCode::WrongState, "another dtsd already runs in " + directory,
                      "stop it, or set " + variable + " to another directory");
  }
  return DirectoryLock(fd);
}

DirectoryLock::~DirectoryLock() {
  if (fd_ >= 0) ::close(fd_);  // releases the lock; keeps the file, because removing it would race with another daemon
}

}  // namespace dts::app
