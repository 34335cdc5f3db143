// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/chunk_stream.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "record/damaged.h"
#include "record/xdf/byte_codec.h"

namespace dts::record {
namespace {

constexpr std::size_t kReadBytes = 256U << 10U;

}  // namespace

core::Result<std::unique_ptr<ChunkStream>> ChunkStream::open(const std::string& file) {
  // O_NONBLOCK: opening a pipe with a recording's name must not block.
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return core::fail_errno(errno, "cannot open " + file);
  struct stat there {};
  const bool is_file = ::fstat(descriptor, &there) == 0 && S_ISREG(there.st_mode);
  std::unique_ptr<ChunkStream> stream(new ChunkStream(descriptor, is_file ? static_cast<std::uint64_t>(there.st_size) : 0));
  if (!is_file) return core::fail(core::ErrorCode::Failed, file + " is not a readable file");
  if (auto status = stream->append_bytes(kMagic.size()); !status || stream->chunk_ != kMagic)
    return core::fail(kDamaged, file + " is not an XDF file", "choose an XDF file: it starts with 'XDF:'");
  stream->offset_ = kMagic.size();
  return stream;
}

ChunkStream::~ChunkStream() { ::close(descriptor_); }

tl::unexpected<core::Error> ChunkStream::damaged(const std::string& why) const {
  return core::fail(kDamaged, why + " at byte " + std::to_string(offset_));
}

/// Appends bytes of the file to the chunk. The caller has checked the size of the file, but the file may have been truncated since then.
core::Status ChunkStream::append_bytes(std::size_t count) {
  while (count > 0) {
    if (buffer_used_ == buffer_.size()) {
      buffer_.resize(kReadBytes);
      buffer_used_ = 0;
      ssize_t received = ::read(descriptor_, buffer_.data(), buffer_.size());
      while (received < 0 && errno == EINTR) received = ::read(descriptor_, buffer_.data(), buffer_.size());
      const int error = errno;
      buffer_.resize(static_cast<std::size_t>(std::max<ssize_t>(received, 0)));
      if (received < 0) return core::fail_errno(error, "cannot continue reading at byte " + std::to_string(offset_));
      if (received == 0) return damaged("chunk torn");
    }
    const std::size_t taken = std::min(count, buffer_.size() - buffer_used_);
    chunk_.append(buffer_, buffer_used_, taken);
    buffer_used_ += taken;
    count -= taken;
  }
  return {};
}

/// Returns the length of tag and content; leaves the length prefix in `chunk_`.
core::Result<std::uint64_t> ChunkStream::read_length() {
  DTS_TRY(append_bytes(1));
  const auto length_bytes = static_cast<unsigned char>(chunk_.front());
  if (length_bytes != 1 && length_bytes != 4 && length_bytes != 8) return damaged("no chunk");
  if (size_ - offset_ < 1U + length_bytes) return damaged("chunk torn");
  DTS_TRY(append_bytes(length_bytes));
  std::uint64_t length = 0;
  if (!ByteCursor(chunk_).read_length(length) || length < sizeof(std::uint16_t)) return damaged("chunk without a tag");
  if (length > kMaxChunkBytes) return damaged("chunk of " + std::to_string(length) + " bytes (at most 64 MiB are allowed)");
  if (length > size_ - offset_ - chunk_.size()) return damaged("chunk torn");
  return length;
}

core::Result<std::optional<RawChunk>> ChunkStream::next() {
  if (offset_ >= size_) return std::optional<RawChunk>();
  chunk_.clear();
  DTS_TRY_ASSIGN(const auto length, read_length());
  const std::size_t prefix_bytes = chunk_.size();
  DTS_TRY(append_bytes(static_cast<std::size_t>(length)));
  RawChunk raw{.offset = offset_, .bytes = chunk_};
  ByteCursor cursor(raw.bytes.substr(prefix_bytes));
  if (!cursor.read(raw.tag)) return damaged("chunk without a tag");
  raw.content = cursor.left();
  offset_ += chunk_.size();
  return std::optional(raw);
}

}  // namespace dts::record
