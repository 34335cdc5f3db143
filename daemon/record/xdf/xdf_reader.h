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

/// What the file header holds: the facts under <desc>, of whatever program.
struct FileHeader {
  std::vector<std::pair<std::string, std::string>> facts;
};
struct StreamHeader {
  std::uint32_t stream = 0;  ///< Number in the file.
  StreamInfo info;
};
/// Samples of one chunk; times of all of them, given or counted on from the one before.
struct Samples {
  std::uint32_t stream = 0;
  std::vector<double> times_s;
  std::vector<double> values;      ///< `values[sample * channels + channel]`; empty for texts.
  std::vector<std::string> texts;  ///< The same for texts.
  bool has_first_time = false;     ///< The first time stamp stands in the file.
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
/// A tag this reader does not know: skipped, as the specification asks for.
struct UnknownChunk {
  std::uint16_t tag = 0;
};

/// One chunk with its place in the file.
struct Chunk {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;  ///< With its length prefix.
  std::variant<FileHeader, StreamHeader, Samples, ClockOffset, Boundary, StreamFooter, UnknownChunk> content;
};

/// Reads an XDF 1.0 file of any program chunk by chunk. Never trusts the file: lengths and counts are checked against what is left of it
/// before memory is taken, at most a few times the largest chunk (64 MiB) is held, and every fault is told with its offset.
/// Thread: one at a time.
class XdfReader {
 public:
  /// Fails with NotFound or Failed (it cannot be read) and with DataDamaged (it is no XDF).
  [[nodiscard]] static core::Result<std::unique_ptr<XdfReader>> open(const std::string& file);
  virtual ~XdfReader() = default;

  /// The next chunk; nothing at the end of the file. DataDamaged: what follows cannot be read; `offset()` is where the last whole
  /// chunk ends. After an error every call fails the same way.
  [[nodiscard]] virtual core::Result<std::optional<Chunk>> next() = 0;
  [[nodiscard]] virtual std::uint64_t offset() const noexcept = 0;
  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
};

}  // namespace dts::record
