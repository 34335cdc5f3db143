// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/cell_text.h"
#include "core/rate.h"
#include "record/catalogue/corrections.h"
#include "record/old_event.h"
#include "record/recording.h"
#include "record/stream_info.h"

namespace dts::record {

/// Longest text that a function below writes for one number.
inline constexpr std::size_t kLongestNumber = 32;

/// Write a number at `at`, which must have room for kLongestNumber, and return the end of the text.
[[nodiscard]] char* put_count(char* at, std::uint64_t count) noexcept;
/// Writes seconds with up to nine decimals, without trailing zeros: "0.01", "-1.5", "3".
[[nodiscard]] char* put_seconds(char* at, std::int64_t time_ns) noexcept;
/// Writes seconds with exactly six decimals, rounded.
[[nodiscard]] char* put_microseconds(char* at, std::int64_t time_ns) noexcept;
/// Writes the shortest text that reads back as exactly this value in the stream's type; `undefined` for NaN.
[[nodiscard]] char* put_value(char* at, double value, ValueType type, std::string_view undefined) noexcept;

/// Returns the channel's name with its unit at the end: "ml_mm" does not change; "Fz" in "N" becomes "Fz_n".
[[nodiscard]] std::string name_with_unit(const ChannelInfo& channel);
using core::csv_cell;
/// Returns a cell of a BIDS table, which has no quotes: `core::as_cell` without tabs and line ends; "n/a" for an empty text.
[[nodiscard]] std::string tsv_cell(std::string_view text);

/// Returns the cells of an event; `details` is the JSON of the rest of its message. An event that dtsd 0.1 recorded gets the cells that
/// dtsd 0.1 wrote.
[[nodiscard]] EventCells cells_of(const TimedEvent& timed);

/// Gives markers their corrected texts. Call it with all events of a recording, in order: it counts the markers.
class MarkerTexts {
 public:
  MarkerTexts(const Recording& recording, const Corrections& corrections)
      : corrections_(&corrections), part_(recording.session() ? leading_part(*recording.session()) : 1) {}

  /// Returns the event; a marker with its corrected text, which is empty if a person removed it.
  [[nodiscard]] TimedEvent corrected(TimedEvent timed);

 private:
  const Corrections* corrections_;
  std::uint32_t part_;  ///< That corrections name.
  std::uint32_t count_ = 0;
};

/// Converts seconds to whole nanoseconds. Limits values outside the range of 64 bits to the nearest one inside.
[[nodiscard]] std::int64_t to_ns(double seconds) noexcept;

/// Times of a regular stream's scans since the recording's first scan. Within a segment they are computed from the scan index and the exact
/// rate, so that rounded time stamps cause no jitter. If a time stamp differs from the computed time, the computation restarts from it.
class TimeAxis {
 public:
  TimeAxis(double origin_s, core::Rate rate) : origin_s_(origin_s), rate_(rate) {}

  /// Call it with all recorded scans of the stream, in order.
  void begin(const RecordedScans& scans) noexcept;
  /// Returns the time of one scan; `place` is its index in the scans of the last `begin`.
  [[nodiscard]] std::int64_t time_ns(std::size_t place) const noexcept;

 private:
  struct Anchor {
    std::uint32_t segment = 0;
    std::uint64_t scan = 0;
    std::int64_t time_ns = 0;
  };
  [[nodiscard]] std::int64_t predicted_ns(std::uint64_t scan) const noexcept;

  double origin_s_;
  core::Rate rate_;
  std::optional<Anchor> anchor_;
  std::uint64_t first_scan_ = 0;
};

}  // namespace dts::record
