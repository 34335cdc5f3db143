// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/losses.h"
#include "core/result.h"
#include "core/units.h"
#include "dts/v1/stream.pb.h"
#include "record/session_facts.h"
#include "record/stream_info.h"

namespace dts::record {

/// Consecutive scans of one regular stream, within one segment.
struct RecordedScans {
  std::size_t stream = 0;  ///< Index into `Recording::streams()`.
  std::uint32_t segment = 0;
  core::ScanIndex first_scan;
  double first_time_s = 0.0;
  std::size_t count = 0;
  std::vector<double> values{};  ///< `values[scan * channels + channel]`
};
/// One sample of an irregular stream of numbers.
struct RecordedChange {
  std::size_t stream = 0;
  std::uint32_t segment = 0;
  core::ScanIndex scan;
  double time_s = 0.0;
  std::vector<double> values{};
};
struct TimedEvent {
  double time_s = 0.0;
  v1::Event event;
  std::string old_text{};  ///< The event as dtsd 0.1 recorded it, for exports; empty if it has the present form.
};
struct RecordedOffset {
  double time_s = 0.0;
  double offset_s = 0.0;
  std::size_t stream = 0;
};
using RecordedItem = std::variant<RecordedScans, RecordedChange, TimedEvent, RecordedOffset>;

/// A recording as scans and events instead of chunks and time stamps. `open` reads the whole file once to find its streams and segments;
/// `next` then returns its items in file order. Opens recordings of other programs too: there a time stamp that is off the grid by more
/// than half a scan starts a segment, and texts that are not our events become markers. Thread: one at a time.
class Recording {
 public:
  /// Fails like XdfReader::open. If the end of the file is torn, reads up to that place; see `damage`.
  [[nodiscard]] static core::Result<std::unique_ptr<Recording>> open(const std::string& file);
  virtual ~Recording() = default;

  [[nodiscard]] virtual const std::vector<StreamInfo>& streams() const noexcept = 0;
  /// Returns the index of the stream "<rig>/<name>" or "<name>"; nothing if there is no such stream.
  [[nodiscard]] virtual std::optional<std::size_t> find_stream(const std::string& name) const = 0;
  /// Absent in files of other programs.
  [[nodiscard]] virtual const std::optional<SessionFacts>& session() const noexcept = 0;
  /// Why the file is not whole: torn, incomplete, recovered. Empty: nothing is wrong.
  [[nodiscard]] virtual const std::string& damage() const noexcept = 0;
  /// Scans missing between the first and the last.
  [[nodiscard]] virtual const core::Losses& losses() const noexcept = 0;
  /// From the first scan of the raw stream (without one: of the fastest stream) to the end of its last, gaps included.
  [[nodiscard]] virtual double duration_s() const noexcept = 0;
  /// Number of samples of a stream in the whole file.
  [[nodiscard]] virtual std::uint64_t sample_count(std::size_t stream) const = 0;

  /// Returns the next item; nothing at the end.
  [[nodiscard]] virtual core::Result<std::optional<RecordedItem>> next() = 0;
  /// Makes `next` start again from the beginning.
  virtual core::Status rewind() = 0;
  [[nodiscard]] virtual std::uint64_t offset() const noexcept = 0;  ///< Bytes of `size()` that `next` has read: for progress bars.
  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
};

/// Reads the session facts of one of our recordings from its first chunk, and nothing more. Fails with Unsupported for a file of another
/// program.
[[nodiscard]] core::Result<SessionFacts> read_session_facts(const std::string& file);

}  // namespace dts::record
