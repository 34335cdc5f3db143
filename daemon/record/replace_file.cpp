// SPDX-License-Identifier: Apache-2.0
#include "record/replace_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

namespace dts::record {
namespace {

core::Status failed(int error, const std::string& file) {
  return core::fail_errno(error, "cannot write '" + file + "'", "check whether the disk is full or read-only; nothing was changed");
}

}  // namespace

void synchronise_folder(const std::string& folder) noexcept {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  static_cast<void>(::fsync(descriptor));
  ::close(descriptor);
}

core::Status replace_file(const std::string& file, std::string_view text, mode_t mode) {
  const std::string temporary = file + ".new";
  static_cast<void>(::unlink(temporary.c_str()));  // a crash left it
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
  if (descriptor < 0) return failed(errno, file);
  const ssize_t written = ::write(descriptor, text.data(), text.size());
  int error = 0;
  if (written != static_cast<ssize_t>(text.size())) error = written < 0 ? errno : ENOSPC;
  if (error == 0 && ::fsync(descriptor) != 0) error = errno;
  ::close(descriptor);
  if (error == 0 && ::rename(temporary.c_str(), file.c_str()) != 0) error = errno;
  if (error == 0) return synchronise_folder(std::filesystem::path(file).parent_path().string()), core::Status();
  static_cast<void>(::unlink(temporary.c_str()));
  return failed(error, file);
}

}  // namespace dts::record
