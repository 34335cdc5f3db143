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

/// A whole chunk and its note for the index. `DurableFile::append` sets offset, length and CRC of `note`.
struct NotedChunk {
  std::string bytes;
  ChunkNote note{};
};

/// The two files of an open recording, NAME.part and NAME.idx. Appends chunks without knowing their content. Cuts off torn chunks if the
/// disk allows it. Computes the SHA-256 while writing, so that nobody must read the file again. Thread: one at a time.
class DurableFile {
 public:
  /// A state to which `cut_back` can truncate the files.
  struct Mark {
    std::uint64_t bytes = 0;
    std::uint64_t index_bytes = 0;
    crypto_hash_sha256_state hash{};
    std::string owed_lines{};
  };

  /// Creates both files (mode 0640), writes the magic bytes and `first`, and synchronises them to the disk before it returns. Fails with
  /// WrongState if NAME or one of the two files exists. If it fails, it leaves no files behind.
  [[nodiscard]] static core::Result<std::unique_ptr<DurableFile>> create(const std::string& name, NotedChunk first);
  ~DurableFile() { close_descriptors(); }
  DurableFile(const DurableFile&) = delete;
  DurableFile& operator=(const DurableFile&) = delete;

  /// Writes all chunks with one write, then their index lines with another. If the first write fails, cuts off the torn chunk.
  [[nodiscard]] core::Status append(std::span<NotedChunk> chunks);
  [[nodiscard]] core::Status synchronise();
  [[nodiscard]] Mark mark() const { return {bytes_, index_bytes_, hash_, owed_lines_}; }
  [[nodiscard]] core::Status cut_back(const Mark& mark);

  /// Synchronises the file, renames it to its final name unless that exists, synchronises the folder and makes the file read-only.
  [[nodiscard]] core::Status publish();
  /// Removes both files.
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
  std::string owed_lines_;  ///< Index lines that could not be written although their chunks are in the file.
  crypto_hash_sha256_state hash_{};
};

/// Returns a SHA-256 as hexadecimal text.
[[nodiscard]] std::string hexadecimal_sha256(crypto_hash_sha256_state state);

}  // namespace dts::record
