// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "core/units.h"
#include "record/stream_info.h"

namespace dts::record {

/// Writes one XDF 1.0 file (github.com/sccn/xdf/wiki/Specifications), append-only: completes every chunk in memory, writes it with one
/// write(2), and never rewrites anything. Writes a stream's header with its first data, because libxdf crashes on a regular stream without
/// samples.
///
///     NAME.part      the file while it grows; renamed to NAME when closed, read-only
///     NAME.idx       one line per chunk, see `ChunkNote`; is kept
///
/// After an error the writer is broken: every call except `abandon` and `close_incomplete` fails with the first error. The writer cuts off
/// a torn chunk if the disk allows it, so that the file ends with a whole chunk. A wrong call (InvalidArgument, WrongState, LimitExceeded:
/// half a scan, a time that is not finite, a chunk of more than 64 MiB) writes nothing and does not break the writer. Thread: one at a
/// time.
class XdfWriter {
 public:
  /// Place of a chunk's samples, for the index.
  struct Position {
    std::uint32_t segment = 0;
    core::ScanIndex first_scan;
  };

  /// Creates NAME.part and NAME.idx (mode 0640), writes the file header with `facts`, and synchronises both files and the folder before it
  /// returns, so that the recording survives a crash. Fails if NAME, NAME.part or NAME.idx exists.
  [[nodiscard]] static core::Result<std::unique_ptr<XdfWriter>> create(const std::string& name,
                                                                       const std::vector<std::pair<std::string, std::string>>& facts);
  ~XdfWriter();  ///< Does the same as `abandon`.
  XdfWriter(const XdfWriter&) = delete;
  XdfWriter& operator=(const XdfWriter&) = delete;

  /// Adds a stream and returns its number. Its header is written with its first samples; until then `add_fact` can add facts.
  [[nodiscard]] std::uint32_t add_stream(StreamInfo info);
  void add_fact(std::uint32_t stream, const std::string& name, const std::string& value);

  /// Writes samples of a regular stream, scan by scan (`values[scan * channels + channel]`). Only the first has a time stamp; readers
  /// compute the others from it.
  [[nodiscard]] core::Status write_samples(std::uint32_t stream, double first_time_s, std::span<const double> values, Position position);
  /// Writes samples of an irregular stream, each with its time stamp.
  [[nodiscard]] core::Status write_timed(std::uint32_t stream, std::span<const double> times_s, std::span<const double> values,
                                         Position position);
  [[nodiscard]] core::Status write_texts(std::uint32_t stream, std::span<const std::pair<double, std::string>> texts, Position position);
  /// Writes a clock offset measured at `stream_time_s`: `offset_s` + stream time = CLOCK_MONOTONIC of the host. The stream must have
  /// samples in the file.
  [[nodiscard]] core::Status write_clock_offset(std::uint32_t stream, double stream_time_s, double offset_s);
  /// Writes a mark at which a reader can continue after damage.
  [[nodiscard]] core::Status write_boundary();
  /// Calls fdatasync for the file, then for the index. Blocks for milliseconds.
  [[nodiscard]] core::Status synchronise();

  struct Closed {
    std::string file;    ///< Final name.
    std::string sha256;  ///< Of the file's content, hexadecimal.
    std::uint64_t bytes = 0;
  };
  /// Writes the footers, synchronises the file, renames it, synchronises the folder and makes the file read-only.
  [[nodiscard]] core::Result<Closed> close();
  /// Closes a recording that lacks data: writes `reason` as the fact `incomplete` in the footers. Works after an error, as far as the disk
  /// allows; if that fails too, NAME.part stays.
  [[nodiscard]] core::Result<Closed> close_incomplete(const std::string& reason);
  /// Closes the file descriptors and leaves NAME.part unchanged, like a crash.
  void abandon() noexcept;

  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Returns the number of samples written so far.
  [[nodiscard]] std::uint64_t sample_count(std::uint32_t stream) const noexcept;

 private:
  class Implementation;
  explicit XdfWriter(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace dts::record
