// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/result.h"
#include "record/stream_info.h"

namespace dts::record {

/// The file header: the facts under <desc>, written by any program.
struct FileHeader {
  std::vector<std::pair<std::string, std::string>> facts;
};
struct StreamHeader {
  std::uint32_t stream = 0;  ///< Stream number in the file.
  StreamInfo info;
};
/// Samples of one chunk. Each has a time: its time stamp, or one computed from the previous time stamp.
struct Samples {
  std::uint32_t stream = 0;
  std::vector<double> times_s;
  std::vector<double> values;      ///< `values[sample * channels + channel]`; empty for texts.
  std::vector<std::string> texts;  ///< `texts[sample * channels + channel]`; empty for numbers.
  bool has_first_time = false;     ///< The first sample has a time stamp in the file.
};
struct ClockOffset {
  std::uint32_t stream = 0;
  double stream_time_s = 0.0;
  double offset_s = 0.0;
};
struct Boundary {};
struct StreamFooter {
  std::uint32_t stream = 0;
  std::optional<double> first_time_s;
  std::optional<double> last_time_s;
  std::optional<std::uint64_t> sample_count;
  std::vector<std::pair<std::string, std::string>> facts;  ///< "incomplete", "recovered", "lost_s_at_most"
};
/// A chunk with a tag that this reader does not know. Readers skip it, as the specification requires.
struct UnknownChunk {
  std::uint16_t tag = 0;
};

/// One chunk with its place in the file.
struct Chunk {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  ///< In bytes, with its length prefix.
  std::variant<FileHeader, StreamHeader, Samples, ClockOffset, Boundary, StreamFooter, UnknownChunk> content;
};

/// Reads an XDF 1.0 file of any program chunk by chunk. Does not trust the file: checks lengths and counts against the rest of the file
/// before it allocates memory, holds at most a few times the largest chunk (64 MiB), and reports every fault with its offset.
/// Thread: one at a time.
class XdfReader {
 public:
  /// Fails with NotFound, NotAllowed or Failed if the file cannot be read, and with DataDamaged if it is no XDF.
  [[nodiscard]] static core::Result<std::unique_ptr<XdfReader>> open(const std::string& file);
  virtual ~XdfReader() = default;

  /// Returns the next chunk; nothing at the end of the file. Fails with DataDamaged if the next chunk cannot be read; `offset()` is then
  /// the end of the last readable chunk. After an error every call fails with the same error.
  [[nodiscard]] virtual core::Result<std::optional<Chunk>> next() = 0;
  [[nodiscard]] virtual std::uint64_t offset() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
};

}  // namespace dts::record
