// SPDX-License-Identifier: Apache-2.0
#include "app/paths.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>

namespace dts::app {
namespace {

constexpr mode_t kDirectoryMode = 0750;

const char* environment(const char* name) {
  const char* value = std::getenv(name);
  return value != nullptr && *value != '\0' ? value : nullptr;
}

}  // namespace

std::string runtime_directory() {
  if (const char* given = environment("DTSD_RUNTIME_DIR")) return given;
  if (const char* systemd = environment("RUNTIME_DIRECTORY")) return systemd;
  if (const char* user = environment("XDG_RUNTIME_DIR")) return std::string(user) + "/dtsd";
  return "/tmp/dtsd-" + std::to_string(::getuid());
}

core::Status prepare_directory(const std::string& path) {
  const std::string hint = "set DTSD_RUNTIME_DIR to a directory of your own";
  std::error_code error;
  const auto parent = std::filesystem::path(path).parent_path();
  if (!parent.empty()) std::filesystem::create_directories(parent, error);
  if (::mkdir(path.c_str(), kDirectoryMode) != 0 && errno != EEXIST) {
    return core::fail_errno(errno, "runtime directory " + path + " cannot be made", hint);
  }
  struct stat found {};
  // lstat: in /tmp somebody else could have put a link in our place.
  if (::lstat(path.c_str(), &found) != 0) return core::fail_errno(errno, "runtime directory " + path, hint);
  if (!S_ISDIR(found.st_mode)) return core::fail(core::ErrorCode::Failed, "runtime directory " + path + " is not a directory", hint);
  if (found.st_uid != ::geteuid()) {
    return core::fail(core::ErrorCode::NotAllowed, "runtime directory " + path + " belongs to another user", hint);
  }
  if ((found.st_mode & S_IWOTH) != 0) {
    return core::fail(core::ErrorCode::NotAllowed, "runtime directory " + path + " can be written by everybody", "chmod o-rwx " + path);
  }
  if (::access(path.c_str(), W_OK | X_OK) != 0) return core::fail_errno(errno, "runtime directory " + path + " cannot be written", hint);
  return {};
}

core::Result<RuntimeLock> RuntimeLock::take(const std::string& directory) {
  const std::string path = directory + "/dtsd.lock";
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0) return core::fail_errno(errno, "lock file " + path, "set DTSD_RUNTIME_DIR to a directory of your own");
  if (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    ::close(fd);
    return core::fail(core::ErrorCode::WrongState, "another dtsd already runs in " + directory,
                      "stop it, or set DTSD_RUNTIME_DIR to another directory");
  }
  return RuntimeLock(fd);
}

RuntimeLock::~RuntimeLock() {
  if (fd_ >= 0) ::close(fd_);  // closing gives the lock back; the file stays, removing it would race with another taker
}

}  // namespace dts::app
