// SPDX-License-Identifier: Apache-2.0
#include "record/export/output_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <utility>

namespace dts::record {
namespace {

constexpr std::size_t kBufferBytes = 1U << 18U;
constexpr mode_t kFileMode = 0640;  // not for others: data of subjects
constexpr mode_t kFolderMode = 0750;
constexpr const char* kOtherFolder = "choose a folder that you may write into";

core::Status already_there(const std::string& path) {
  return core::fail(core::ErrorCode::WrongState, "'" + path + "' exists already: an export never overwrites a file",
                    "choose another folder, or move it away");
}

/// Renames a file, but never replaces an existing one. Uses a hard link on file systems without RENAME_NOREPLACE (some network ones), and
/// checks for the file first on those without hard links (FAT).
int rename_without_replacing(const std::string& from, const std::string& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  if (::link(from.c_str(), to.c_str()) == 0) return ::unlink(from.c_str()) == 0 ? 0 : errno;
  if (errno != EPERM && errno != EOPNOTSUPP) return errno;
  if (::access(to.c_str(), F_OK) == 0) return EEXIST;
  return ::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

std::string temporary_name(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return path.substr(0, slash + 1) + "." + path.substr(slash + 1) + ".part";
}

}  // namespace

OutputFile::OutputFile(std::string name, std::string temporary, int descriptor, bool may_replace)
    : name_(std::move(name)), temporary_(std::move(temporary)), descriptor_(descriptor), may_replace_(may_replace) {}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

char* OutputFile::reserve(std::size_t bytes) {
  if (used_ + bytes > buffer_.size()) flush();
  if (bytes > buffer_.size()) buffer_.resize(std::max(bytes, kBufferBytes));
  return buffer_.data() + used_;
}

void OutputFile::append(std::string_view text) { advance(std::copy(text.begin(), text.end(), reserve(text.size()))); }

core::Status OutputFile::status() const {
  if (system_errno_ == 0) return {};
  return core::fail_errno(system_errno_, "cannot write '" + name_ + "'", "make room, or choose another folder");
}

void OutputFile::flush() noexcept { write_all(buffer_.data(), std::exchange(used_, 0)); }

void OutputFile::write_all(const char* from, std::size_t bytes) noexcept {
  while (bytes > 0 && system_errno_ == 0) {
    const ssize_t written = ::write(descriptor_, from, bytes);
    if (written < 0) {
      if (errno != EINTR) system_errno_ = errno;
      continue;
    }
    from += written;
    bytes -= static_cast<std::size_t>(written);
    bytes_ += static_cast<std::uint64_t>(written);
  }
}

void OutputFile::close() noexcept {
  flush();
  if (::close(std::exchange(descriptor_, -1)) != 0 && system_errno_ == 0) system_errno_ = errno;
  buffer_ = {};
}

OutputFiles::OutputFiles(std::string folder) : folder_(std::move(folder)) {
  while (folder_.size() > 1 && folder_.ends_with('/')) folder_.pop_back();
  if (folder_.empty()) folder_ = ".";
}

OutputFiles::~OutputFiles() {
  if (is_committed_) return;
  files_.clear();
  for (auto folder = made_folders_.rbegin(); folder != made_folders_.rend(); ++folder) ::rmdir(folder->c_str());
}

core::Result<OutputFile*> OutputFiles::create(const std::string& name) { return open(name, false); }

core::Status OutputFiles::put(const std::string& name, std::string_view text) {
  return open(name, false).map([&](OutputFile* file) { file->append(text); });
}

core::Status OutputFiles::replace(const std::string& name, std::string_view text) {
  return open(name, true).map([&](OutputFile* file) { file->append(text); });
}

core::Result<OutputFile*> OutputFiles::open(const std::string& name, bool may_replace) {
  const std::string full = path(name);
  DTS_TRY(make_folder(full.substr(0, full.rfind('/'))));
  struct stat there {};
  if (!may_replace && ::lstat(full.c_str(), &there) == 0) return tl::make_unexpected(already_there(full).error());
  const std::string temporary = temporary_name(full);
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kFileMode);
  if (descriptor < 0 && errno == EEXIST) {
    return core::fail(core::ErrorCode::WrongState, "'" + temporary + "' exists: another export is running, or one was killed",
                      "if no other export is running, delete that file");
  }
  if (descriptor < 0) return core::fail_errno(errno, "cannot create '" + full + "'", kOtherFolder);
  files_.push_back(std::unique_ptr<OutputFile>(new OutputFile(full, temporary, descriptor, may_replace)));
  return files_.back().get();
}

core::Status OutputFiles::make_folder(const std::string& path) {
  if (path.empty()) return {};
  if (::mkdir(path.c_str(), kFolderMode) == 0) {
    made_folders_.push_back(path);
    return {};
  }
  struct stat there {};
  if (errno == EEXIST && ::stat(path.c_str(), &there) == 0 && S_ISDIR(there.st_mode)) return {};
  const int why = errno;
  const std::size_t slash = path.rfind('/');
  if (why != ENOENT || slash == std::string::npos) return core::fail_errno(why, "cannot create the folder '" + path + "'", kOtherFolder);
  DTS_TRY(make_folder(path.substr(0, slash)));
  if (::mkdir(path.c_str(), kFolderMode) != 0) return core::fail_errno(errno, "cannot create the folder '" + path + "'", kOtherFolder);
  made_folders_.push_back(path);
  return {};
}

core::Result<OutputFiles::Written> OutputFiles::commit() {
  Written written;
  for (const auto& file : files_) {
    file->close();
    DTS_TRY(file->status());
  }
  // Files that replace existing ones are last: then only their own renames can still fail.
  std::vector<std::string> new_files;
  std::ranges::stable_partition(files_, [](const auto& file) { return !file->may_replace_; });
  for (const auto& file : files_) {
    const int failed = file->may_replace_ ? (::rename(file->temporary_.c_str(), file->name_.c_str()) == 0 ? 0 : errno)
                                          : rename_without_replacing(file->temporary_, file->name_);
    if (failed != 0) {
      for (const std::string& made : new_files) ::unlink(made.c_str());
      if (failed == EEXIST) return tl::make_unexpected(already_there(file->name_).error());
      return core::fail_errno(failed, "cannot give '" + file->name_ + "' its final name");
    }
    file->temporary_.clear();
    if (!file->may_replace_) new_files.push_back(file->name_);
    written.bytes += file->bytes_;
    written.files.push_back(file->name_);
  }
  is_committed_ = true;
  return written;
}

}  // namespace dts::record
