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

/// Writes one XDF 1.0 file (github.com/sccn/xdf/wiki/Specifications), append-only: every chunk is complete in memory before one
/// write(2) takes it, and nothing is ever rewritten. A stream's header is written with its first data (libxdf crashes on a regular
/// stream without samples).
///
///     NAME.part      the file while it grows; renamed to NAME when closed, read-only
///     NAME.idx       one line per chunk, see `ChunkNote`; stays
///
/// After an error the writer is broken: every call but `abandon` and `close_incomplete` fails with the first error. A chunk that was
/// torn by it is cut off again, so that the file always ends with a whole chunk as far as the disk lets it. A wrong call (InvalidArgument,
/// WrongState, LimitExceeded: half a scan, a time that is not finite, a chunk of more than 64 MiB) writes nothing and breaks nothing.
/// Thread: one at a time.
class XdfWriter {
 public:
  /// Where the samples of a chunk stand, for the index.
  struct Position {
    std::uint32_t segment = 0;
    core::ScanIndex first_scan;
  };

  /// Creates NAME.part and NAME.idx (mode 0640), writes the file header with `facts`, and synchronises both files and the folder before it
  /// returns: from then on the recording exists whatever happens. Fails when NAME, NAME.part or NAME.idx exists.
  [[nodiscard]] static core::Result<std::unique_ptr<XdfWriter>> create(const std::string& name,
                                                                       const std::vector<std::pair<std::string, std::string>>& facts);
  ~XdfWriter();  ///< As `abandon`.
  XdfWriter(const XdfWriter&) = delete;
  XdfWriter& operator=(const XdfWriter&) = delete;

  /// Announces a stream and returns its number. It is written with its first samples; until then `add_fact` may complete it.
  [[nodiscard]] std::uint32_t add_stream(StreamInfo info);
  void add_fact(std::uint32_t stream, const std::string& name, const std::string& value);

  /// Samples of a regular stream, scan by scan (`values[scan * channels + channel]`). Only the first has a time stamp; readers count on
  /// from it.
  [[nodiscard]] core::Status write_samples(std::uint32_t stream, double first_time_s, std::span<const double> values, Position position);
  /// Samples of an irregular stream, one time stamp each.
  [[nodiscard]] core::Status write_timed(std::uint32_t stream, std::span<const double> times_s, std::span<const double> values,
                                         Position position);
  [[nodiscard]] core::Status write_texts(std::uint32_t stream, std::span<const std::pair<double, std::string>> texts, Position position);
  /// `offset_s` + stream time = CLOCK_MONOTONIC of the host, measured at `stream_time_s`. Only for streams that have been written.
  [[nodiscard]] core::Status write_clock_offset(std::uint32_t stream, double stream_time_s, double offset_s);
  /// A mark from which a reader can start again.
  [[nodiscard]] core::Status write_boundary();
  /// fdatasync of file, then index. Blocks for milliseconds.
  [[nodiscard]] core::Status synchronise();

  struct Closed {
    std::string file;    ///< Final name.
    std::string sha256;  ///< Of its content, hexadecimal.
    std::uint64_t bytes = 0;
  };
  /// Footers, synchronise, rename, folder synchronised, read-only.
  [[nodiscard]] core::Result<Closed> close();
  /// The same for a recording that lacks something: `reason` stands in a footer fact `incomplete`. Tries what the disk still lets it do;
  /// when even that fails, NAME.part stays.
  [[nodiscard]] core::Result<Closed> close_incomplete(const std::string& reason);
  /// Closes the descriptors and leaves NAME.part as it is: what a crash does.
  void abandon() noexcept;

  [[nodiscard]] std::uint64_t bytes() const noexcept;
  /// Samples written so far.
  [[nodiscard]] std::uint64_t sample_count(std::uint32_t stream) const noexcept;

 private:
  class Implementation;
  explicit XdfWriter(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace dts::record
