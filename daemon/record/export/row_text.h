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
#include "record/event.h"
#include "record/recording.h"
#include "record/stream_info.h"

namespace dts::record {

/// Longest text that any of the functions below makes of one number.
inline constexpr std::size_t kLongestNumber = 32;

/// Each writes at `at`, where room for kLongestNumber must be, and returns where the text ends.
[[nodiscard]] char* put_count(char* at, std::uint64_t count) noexcept;
/// Seconds, with no more of the nine decimals than are needed: "0.01", "-1.5", "3".
[[nodiscard]] char* put_seconds(char* at, std::int64_t time_ns) noexcept;
/// Seconds with exactly six decimals, rounded.
[[nodiscard]] char* put_microseconds(char* at, std::int64_t time_ns) noexcept;
/// The shortest text that reads back, as the stream's own type, as exactly this value; `undefined` for NaN.
[[nodiscard]] char* put_value(char* at, double value, ValueType type, std::string_view undefined) noexcept;

/// "ml_mm" stays; "Fz" in "N" becomes "Fz_n": units stand in every header.
[[nodiscard]] std::string name_with_unit(const ChannelInfo& channel);
using core::csv_cell;
/// A cell of a BIDS table, which knows no quotes: `core::as_cell` without tabs and line ends, "n/a" for nothing.
[[nodiscard]] std::string tsv_cell(std::string_view text);

/// What an event says in one word or sentence: a marker's text, a trial's phase, a state, an edge, a reason.
[[nodiscard]] std::string main_text(const RecordedEvent& event);
/// Everything else it says, as a JSON object; empty when there is nothing else.
[[nodiscard]] std::string further_details(const RecordedEvent& event);
/// The value of a key as text; empty when absent.
[[nodiscard]] std::string value_text(const RecordedEvent& event, std::string_view key);

/// Seconds as whole nanoseconds; times that no clock can show become the nearest that one can.
[[nodiscard]] std::int64_t to_ns(double seconds) noexcept;

/// Times of a regular stream's scans since the recording's first one. Within a segment they follow from the scan index and the exact
/// rate, so that they do not jitter by the rounding of time stamps; a time stamp that disagrees begins anew.
class TimeAxis {
 public:
  TimeAxis(double origin_s, core::Rate rate) : origin_s_(origin_s), rate_(rate) {}

  /// To be called with everything that is recorded of the stream, in order.
  void begin(const RecordedScans& scans) noexcept;
  /// Of the scan with this place among those that `begin` got.
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
