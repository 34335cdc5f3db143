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
#include "record/event.h"
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
/// A sample of an irregular stream of numbers.
struct RecordedChange {
  std::size_t stream = 0;
  std::uint32_t segment = 0;
  core::ScanIndex scan;
  double time_s = 0.0;
  std::vector<double> values{};
};
struct TimedEvent {
  double time_s = 0.0;
  RecordedEvent event;
};
struct RecordedOffset {
  double time_s = 0.0;
  double offset_s = 0.0;
  std::size_t stream = 0;
};
using RecordedItem = std::variant<RecordedScans, RecordedChange, TimedEvent, RecordedOffset>;

/// A recording as scans and events instead of chunks and time stamps. `open` looks through the whole file once for its streams and
/// segments; `next` then goes through it in file order. Recordings of other programs open too: a time stamp off the grid by more than half
/// a scan starts a segment, and texts that are no event of ours become markers. Thread: one at a time.
class Recording {
 public:
  /// Fails as XdfReader. A file that ends torn is read up to there, see `damage`.
  [[nodiscard]] static core::Result<std::unique_ptr<Recording>> open(const std::string& file);
  virtual ~Recording() = default;

  [[nodiscard]] virtual const std::vector<StreamInfo>& streams() const noexcept = 0;
  /// Index of "<rig>/<name>" or of "<name>"; nothing when there is none.
  [[nodiscard]] virtual std::optional<std::size_t> find_stream(const std::string& name) const = 0;
  /// Absent in files of other programs.
  [[nodiscard]] virtual const std::optional<SessionFacts>& session() const noexcept = 0;
  /// Why the file is not whole: torn, incomplete, recovered. Empty when nothing is wrong.
  [[nodiscard]] virtual const std::string& damage() const noexcept = 0;
  /// What is missing between the first scan and the last.
  [[nodiscard]] virtual const core::Losses& losses() const noexcept = 0;
  /// From the first scan of the raw stream (without one: of the fastest) to the end of the last, gaps included.
  [[nodiscard]] virtual double duration_s() const noexcept = 0;
  /// Samples of a stream in the whole file.
  [[nodiscard]] virtual std::uint64_t sample_count(std::size_t stream) const = 0;

  /// Nothing at the end.
  [[nodiscard]] virtual core::Result<std::optional<RecordedItem>> next() = 0;
  /// Starts again from the beginning.
  virtual core::Status rewind() = 0;
  [[nodiscard]] virtual std::uint64_t offset() const noexcept = 0;  ///< Bytes read by `next`, of `size()`: for progress bars.
  [[nodiscard]] virtual std::uint64_t size() const noexcept = 0;
};

/// What a recording of ours says of its session: its first chunk, nothing more is read. Unsupported: it is another program's.
[[nodiscard]] core::Result<SessionFacts> read_session_facts(const std::string& file);

}  // namespace dts::record
