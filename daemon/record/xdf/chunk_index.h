// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dts::record {

inline constexpr std::string_view kPart = ".part";  ///< File name suffix of a recording that is not closed.

/// One line of the index file of a recording: describes one whole chunk.
///
///     offset length crc32c stream segment first_scan samples time_s
///     1824 3022 9f3c2a11 1 0 375 375 8123.251000000
///
/// For chunks without samples, `stream` and the fields after it are 0. The CRC32C (Castagnoli) covers the whole chunk with its length
/// prefix.
struct ChunkNote {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::uint32_t crc32c = 0;
  std::uint32_t stream = 0;
  std::uint32_t segment = 0;
  std::uint64_t first_scan = 0;
  std::uint64_t samples = 0;
  double time_s = 0.0;

  friend bool operator==(const ChunkNote&, const ChunkNote&) = default;
};

/// Returns the line without its line end.
[[nodiscard]] std::string to_line(const ChunkNote& note);
/// Returns nothing if the line has another form.
[[nodiscard]] std::optional<ChunkNote> note_of_line(std::string_view line);
/// Returns the notes of a file up to the first line that is torn or does not continue the previous one (offset = offset + length). Fails
/// with NotFound if there is no file. Hours of recording need tens of megabytes of memory here; `IndexReader` does not.
[[nodiscard]] core::Result<std::vector<ChunkNote>> read_index(const std::string& file);

/// Reads the notes of an index file one by one.
class IndexReader {
 public:
  explicit IndexReader(const std::string& file);
  [[nodiscard]] bool is_open() const noexcept { return file_.is_open(); }
  /// Returns the next note. Returns nothing at the end, and from the first line on that is torn or does not continue the previous one.
  [[nodiscard]] std::optional<ChunkNote> next();

 private:
  std::ifstream file_;
  std::uint64_t next_offset_ = 4;  ///< After the magic bytes.
  bool is_over_ = false;
};

/// Returns "x.xdf.idx" for "x.xdf" or "x.xdf.part".
[[nodiscard]] std::string index_name(const std::string& recording);

[[nodiscard]] std::uint32_t crc32c(std::string_view bytes) noexcept;

}  // namespace dts::record
