// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>

#include "record/xdf/byte_codec.h"

namespace dts::record {
namespace {

constexpr mode_t kGrowing = 0640;
constexpr mode_t kClosed = 0440;
constexpr const char* kRoomHint = "check that the disk has room and that you may write there";

/// Writes all bytes; returns 0 or the errno. Loops because a write may be short (for example on a full disk).
int write_all(int descriptor, std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    if (written == 0) return EIO;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

int create_new(const std::string& path) noexcept {
  return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_APPEND | O_CLOEXEC, kGrowing);
}

core::Status refuse_existing(int error, const std::string& path) {
  if (error == EEXIST)
    return core::fail(core::ErrorCode::WrongState, path + " exists already", "choose another name: dtsd never overwrites a recording");
  return core::fail_errno(error, "cannot create " + path, kRoomHint);
}

core::Status synchronise_names(const std::string& file) {
  const auto parent = std::filesystem::path(file).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return core::fail_errno(errno, "cannot open the folder " + folder);
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  // Some network file systems reject this call: they synchronise a folder at every change.
  if (error == 0 || error == EINVAL || error == ENOTSUP) return {};
  return core::fail_errno(error, "cannot synchronise the folder " + folder);
}

}  // namespace

std::string hexadecimal_sha256(crypto_hash_sha256_state state) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
  crypto_hash_sha256_final(&state, hash.data());
  std::array<char, 2 * crypto_hash_sha256_BYTES + 1> text{};
  sodium_bin2hex(text.data(), text.size(), hash.data(), hash.size());
  return text.data();
}

DurableFile::DurableFile(std::string name) : name_(std::move(name)), part_name_(name_ + ".part"), index_name_(name_ + ".idx") {
  crypto_hash_sha256_init(&hash_);
}

core::Result<std::unique_ptr<DurableFile>> DurableFile::create(const std::string& name, NotedChunk first) {
  std::unique_ptr<DurableFile> file(new DurableFile(name));
  DTS_TRY(file->open_both());
  if (auto status = file->begin(std::move(first)); !status) {
    file->discard();
    return tl::make_unexpected(status.error());
  }
  return file;
}

core::Status DurableFile::open_both() {
  struct stat there {};
  if (::lstat(name_.c_str(), &there) == 0) return refuse_existing(EEXIST, name_);
  file_ = create_new(part_name_);
  if (file_ < 0) return refuse_existing(errno, part_name_);
  index_ = create_new(index_name_);
  if (index_ >= 0) return {};
  const int error = errno;
  ::unlink(part_name_.c_str());
  return refuse_existing(error, index_name_);
}

core::Status DurableFile::begin(NotedChunk first) {
  DTS_TRY(write_bytes(kMagic));
  DTS_TRY(append({&first, 1}));
  // fsync, not fdatasync: the files are new, so their metadata must be on the disk too.
  if (::fsync(file_) != 0) return core::fail_errno(errno, "cannot synchronise " + part_name_, kRoomHint);
  if (::fsync(index_) != 0) return core::fail_errno(errno, "cannot synchronise " + index_name_, kRoomHint);
  return synchronise_names(name_);
}

core::Status DurableFile::write_bytes(std::string_view bytes) {
  if (const int error = write_all(file_, bytes); error != 0) {
    // The bytes on the disk are torn: cut them off. If that fails, `cut_back` tries again later.
    [[maybe_unused]] const int ignored = ::ftruncate(file_, static_cast<off_t>(bytes_));
    return core::fail_errno(error, "cannot write " + part_name_, kRoomHint);
  }
  crypto_hash_sha256_update(&hash_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  bytes_ += bytes.size();
  return {};
}

core::Status DurableFile::write_index(std::span<const NotedChunk> chunks) {
  for (const auto& chunk : chunks) owed_lines_ += to_line(chunk.note) + '\n';
  if (const int error = write_all(index_, owed_lines_); error != 0) {
    [[maybe_unused]] const int ignored = ::ftruncate(index_, static_cast<off_t>(index_bytes_));
    return core::fail_errno(error, "cannot write " + index_name_, kRoomHint);
  }
  index_bytes_ += owed_lines_.size();
  owed_lines_.clear();
  return {};
}

core::Status DurableFile::append(std::span<NotedChunk> chunks) {
  std::uint64_t offset = bytes_;
  std::string joined;
  for (auto& chunk : chunks) {
    chunk.note.offset = offset;
    chunk.note.length = chunk.bytes.size();
    chunk.note.crc32c = crc32c(chunk.bytes);
    offset += chunk.bytes.size();
    if (chunks.size() > 1) joined += chunk.bytes;
  }
  if (chunks.empty()) return {};
  DTS_TRY(write_bytes(chunks.size() > 1 ? joined : chunks.front().bytes));
  return write_index(chunks);
}

core::Status DurableFile::synchronise() {
  if (::fdatasync(file_) != 0) return core::fail_errno(errno, "cannot synchronise " + part_name_, kRoomHint);
  if (::fdatasync(index_) != 0) return core::fail_errno(errno, "cannot synchronise " + index_name_, kRoomHint);
  return {};
}

core::Status DurableFile::cut_back(const Mark& mark) {
  if (::ftruncate(file_, static_cast<off_t>(mark.bytes)) != 0) return core::fail_errno(errno, "cannot cut " + part_name_);
  bytes_ = mark.bytes;
  hash_ = mark.hash;
  if (::ftruncate(index_, static_cast<off_t>(mark.index_bytes)) != 0) return core::fail_errno(errno, "cannot cut " + index_name_);
  index_bytes_ = mark.index_bytes;
  owed_lines_ = mark.owed_lines;
  return {};
}

core::Status DurableFile::rename_to_final() {
  if (part_name_ == name_) return {};  // an earlier attempt did this and failed later
  int error = 0;
  if (::renameat2(AT_FDCWD, part_name_.c_str(), AT_FDCWD, name_.c_str(), RENAME_NOREPLACE) != 0) error = errno;
  if (error == EINVAL || error == ENOSYS) {  // the file system does not know the flag; link() never replaces a file either
    error = ::link(part_name_.c_str(), name_.c_str()) == 0 ? 0 : errno;
    if (error == 0) ::unlink(part_name_.c_str());
  }
  if (error == EEXIST) return refuse_existing(error, name_);
  if (error != 0) return core::fail_errno(error, "cannot rename " + part_name_ + " to " + name_);
  part_name_ = name_;
  return {};
}

core::Status DurableFile::publish() {
  DTS_TRY(synchronise());
  DTS_TRY(rename_to_final());
  DTS_TRY(synchronise_names(name_));
  // Only a protection against mistakes, so a failure is ignored: file systems without permissions reject it.
  [[maybe_unused]] const int ignored = ::fchmod(file_, kClosed) + ::fchmod(index_, kClosed);
  return {};
}

void DurableFile::discard() noexcept {
  close_descriptors();
  ::unlink(part_name_.c_str());
  ::unlink(index_name_.c_str());
}

void DurableFile::close_descriptors() noexcept {
  for (int* descriptor : {&file_, &index_}) {
    if (*descriptor >= 0) ::close(*descriptor);
    *descriptor = -1;
  }
}

std::string DurableFile::sha256() const { return hexadecimal_sha256(hash_); }

}  // namespace dts::record
