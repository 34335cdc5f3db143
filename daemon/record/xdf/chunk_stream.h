// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dts::record {

/// A chunk as it stands in the file. The views live until the next one is read.
struct RawChunk {
  std::uint64_t offset = 0;
  std::string_view bytes;  ///< With its length prefix.
  std::uint16_t tag = 0;
  std::string_view content;  ///< After the tag.
};

/// Splits a file into chunks, knowing nothing of what is in them. Holds one chunk, of at most 64 MiB, and a read buffer.
class ChunkStream {
 public:
  /// NotFound, NotAllowed or Failed (cannot be read), DataDamaged (does not start as XDF).
  [[nodiscard]] static core::Result<std::unique_ptr<ChunkStream>> open(const std::string& file);
  ~ChunkStream();
  ChunkStream(const ChunkStream&) = delete;
  ChunkStream& operator=(const ChunkStream&) = delete;

  /// Nothing at the end. DataDamaged: no whole chunk stands at `offset()`.
  [[nodiscard]] core::Result<std::optional<RawChunk>> next();
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }  ///< Where the last whole chunk ends.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }      ///< When it was opened.

 private:
  ChunkStream(int descriptor, std::uint64_t size) noexcept : descriptor_(descriptor), size_(size) {}
  [[nodiscard]] core::Status append_bytes(std::size_t count);
  [[nodiscard]] core::Result<std::uint64_t> read_length();
  [[nodiscard]] tl::unexpected<core::Error> damaged(const std::string& why) const;

  int descriptor_;
  std::uint64_t size_;
  std::uint64_t offset_ = 0;
  std::string buffer_;  ///< Read from the file, not yet taken.
  std::size_t buffer_used_ = 0;
  std::string chunk_;
};

}  // namespace dts::record
