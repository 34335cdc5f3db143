// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dts::record {

/// The bytes of a chunk in the file. The views are valid until the next `next`.
struct RawChunk {
  std::uint64_t offset = 0;
  std::string_view bytes;  ///< With its length prefix.
  std::uint16_t tag = 0;
  std::string_view content;  ///< After the tag.
};

/// Splits a file into chunks without decoding their content. Holds one chunk, of at most 64 MiB, and a read buffer in memory.
class ChunkStream {
 public:
  /// Fails with NotFound, NotAllowed or Failed if the file cannot be read, and with DataDamaged if it does not start like XDF.
  [[nodiscard]] static core::Result<std::unique_ptr<ChunkStream>> open(const std::string& file);
  ~ChunkStream();
  ChunkStream(const ChunkStream&) = delete;
  ChunkStream& operator=(const ChunkStream&) = delete;

  /// Returns the next chunk, or nothing at the end. Fails with DataDamaged if there is no whole chunk at `offset()`.
  [[nodiscard]] core::Result<std::optional<RawChunk>> next();
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_; }  ///< End of the last whole chunk.
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }      ///< Size when the file was opened.

 private:
  ChunkStream(int descriptor, std::uint64_t size) noexcept : descriptor_(descriptor), size_(size) {}
  [[nodiscard]] core::Status append_bytes(std::size_t count);
  [[nodiscard]] core::Result<std::uint64_t> read_length();
  [[nodiscard]] tl::unexpected<core::Error> damaged(const std::string& why) const;

  int descriptor_;
  std::uint64_t size_;
  std::uint64_t offset_ = 0;
  std::string buffer_;  ///< Bytes from the file; `buffer_used_` of them are already used.
  std::size_t buffer_used_ = 0;
  std::string chunk_;
};

}  // namespace dts::record
