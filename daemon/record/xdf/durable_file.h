// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sodium.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "core/result.h"
#include "record/xdf/chunk_index.h"

namespace dts::record {

/// A whole chunk and what the index says of it. `note`: offset, length and CRC are filled in by `DurableFile::append`.
struct NotedChunk {
  std::string bytes;
  ChunkNote note{};
};

/// A recording's two files while they grow, NAME.part and NAME.idx, as far as nothing in them depends on what chunks mean: append-only,
/// never torn as far as the disk lets it, their SHA-256 at hand without reading them again. Thread: one at a time.
class DurableFile {
 public:
  /// A place to which the files can be cut back.
  struct Mark {
    std::uint64_t bytes = 0;
    std::uint64_t index_bytes = 0;
    crypto_hash_sha256_state hash{};
    std::string owed_lines{};
  };

  /// Creates both (0640); the magic bytes and `first` stand in the file, and all of it is on the disk, when this returns. WrongState when
  /// NAME or one of the two exists. Leaves nothing behind when it fails.
  [[nodiscard]] static core::Result<std::unique_ptr<DurableFile>> create(const std::string& name, NotedChunk first);
  ~DurableFile() { close_descriptors(); }
  DurableFile(const DurableFile&) = delete;
  DurableFile& operator=(const DurableFile&) = delete;

  /// All chunks with one write, then their index lines with another. When the first fails, what was torn is cut off again.
  [[nodiscard]] core::Status append(std::span<NotedChunk> chunks);
  [[nodiscard]] core::Status synchronise();
  [[nodiscard]] Mark mark() const { return {bytes_, index_bytes_, hash_, owed_lines_}; }
  [[nodiscard]] core::Status cut_back(const Mark& mark);

  /// Synchronises, gives it its final name unless that is taken, synchronises the folder and takes away the right to write.
  [[nodiscard]] core::Status publish();
  /// Removes both files: for what nobody needs.
  void discard() noexcept;
  void close_descriptors() noexcept;

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  [[nodiscard]] std::string sha256() const;

 private:
  explicit DurableFile(std::string name);
  [[nodiscard]] core::Status open_both();
  [[nodiscard]] core::Status begin(NotedChunk first);
  [[nodiscard]] core::Status write_bytes(std::string_view bytes);
  [[nodiscard]] core::Status write_index(std::span<const NotedChunk> chunks);
  [[nodiscard]] core::Status rename_to_final();

  std::string name_;
  std::string part_name_;
  std::string index_name_;
  int file_ = -1;
  int index_ = -1;
  std::uint64_t bytes_ = 0;
  std::uint64_t index_bytes_ = 0;
  std::string owed_lines_;  ///< Of the index: their chunks are in the file, they could not be written.
  crypto_hash_sha256_state hash_{};
};

/// A SHA-256 as text.
[[nodiscard]] std::string hexadecimal_sha256(crypto_hash_sha256_state state);

}  // namespace dts::record
