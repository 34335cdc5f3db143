// SPDX-License-Identifier: Apache-2.0
#include "files/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "core/descriptor.h"

namespace dts::files {
namespace {

bool write_all(int descriptor, std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// Creates the temporary file with the permissions of the file that it will replace; if there is none, with `new_mode` minus the umask.
int open_temporary(const std::string& temporary, const struct stat* replaced, mode_t new_mode) noexcept {
  const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, new_mode);
  if (file < 0 || replaced == nullptr || ::fchmod(file, replaced->st_mode & 07777U) == 0) return file;
  ::close(file);
  return -1;
}

tl::unexpected<core::Error> not_written(const std::string& path, int error) {
  return core::fail_errno(error, "cannot write " + path,
                          "check that the folder exists, that you may write there and that the disk has room");
}

}  // namespace

core::Result<WholeFileWriter> WholeFileWriter::create(const std::string& path, mode_t new_mode) {
  struct stat there {};
  const bool exists = ::stat(path.c_str(), &there) == 0;
  if (exists && !S_ISREG(there.st_mode)) {  // a pipe, /dev/stdout: never replaced
    core::Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (file.get() < 0) return not_written(path, errno);
    return WholeFileWriter(path, {}, {}, std::move(file));
  }
  std::error_code unresolved;
  const auto resolved = std::filesystem::weakly_canonical(path, unresolved);  // if `path` is a link, keeps it and replaces its target
  std::string target = unresolved ? path : resolved.string();
  std::string temporary = target + "." + std::to_string(::getpid()) + ".part";
  core::Descriptor file(open_temporary(temporary, exists ? &there : nullptr, new_mode));
  if (file.get() < 0) return not_written(path, errno);
  return WholeFileWriter(path, std::move(target), std::move(temporary), std::move(file));
}

WholeFileWriter::WholeFileWriter(WholeFileWriter&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      file_(std::move(other.file_)) {}

WholeFileWriter::~WholeFileWriter() {
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

core::Status WholeFileWriter::append(std::string_view text) {
  if (!write_all(file_.get(), text)) return not_written(path_, errno);
  return {};
}

core::Status WholeFileWriter::commit() {
  if (temporary_.empty()) return {};
  if (::fsync(file_.get()) != 0 || ::rename(temporary_.c_str(), target_.c_str()) != 0) return not_written(path_, errno);
  temporary_.clear();
  // The file is written. Synchronise the folder, so that the new name survives a power failure; ignore a failure: nothing can be done.
  const auto folder = std::filesystem::path(target_).parent_path();
  const core::Descriptor directory(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.get() >= 0) ::fsync(directory.get());
  return {};
}

core::Status write_whole_file(const std::string& path, std::string_view text, mode_t new_mode) {
  DTS_TRY_ASSIGN(auto writer, WholeFileWriter::create(path, new_mode));
  DTS_TRY(writer.append(text));
  return writer.commit();
}

core::Result<std::string> read_whole_file(const std::string& path, std::size_t most_bytes) {
  const auto refused = [](const std::string& why) { return core::fail(core::ErrorCode::InvalidArgument, why); };
  const auto unreadable = [&refused](int why) { return refused("cannot be read: " + std::generic_category().message(why)); };
  const core::Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  if (file.get() < 0) return errno == ENXIO ? refused("is not a regular file") : unreadable(errno);
  struct stat facts {};
  if (::fstat(file.get(), &facts) != 0) return unreadable(errno);
  if (S_ISDIR(facts.st_mode)) return refused("is a folder, not a file");
  if (!S_ISREG(facts.st_mode)) return refused("is not a regular file");
  std::string text;
  std::array<char, 16384> piece{};
  for (ssize_t got = 1; got != 0;) {
    got = ::read(file.get(), piece.data(), piece.size());
    if (got < 0 && errno != EINTR) return unreadable(errno);
    if (got > 0) text.append(piece.data(), static_cast<std::size_t>(got));
    if (text.size() > most_bytes)
      return refused("is larger than " + std::to_string(most_bytes >> 20U) + " MiB: this is not a file of dtsd");
  }
  return text;
}

}  // namespace dts::files
