// SPDX-License-Identifier: Apache-2.0
#include "record/export/row_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace dts::record {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
/// Greater than the rounding error of a time stamp as large as Unix time (0.24 us), smaller than any scan.
constexpr std::int64_t kStampToleranceNs = 1'000;
/// Keys of an event's main text. The first key that the event has is used.
constexpr std::array<std::string_view, 5> kMainKeys{"text", "phase", "state", "edge", "reason"};

using Values = std::vector<std::pair<std::string, EventValue>>;

Values::const_iterator find_main(const RecordedEvent& event) {
  for (const std::string_view key : kMainKeys) {
    const auto found = std::ranges::find(event.values, key, &Values::value_type::first);
    if (found != event.values.end()) return found;
  }
  return event.values.end();
}

template <class Number>
char* put_shortest(char* at, Number value) noexcept {
  return std::to_chars(at, at + kLongestNumber, value).ptr;
}

/// Returns |a - b| without overflow, for all 64-bit values.
std::uint64_t distance(std::int64_t a, std::int64_t b) noexcept {
  const auto difference = static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b);
  return a >= b ? difference : 0 - difference;
}

/// Writes exactly `digits` decimals of a fraction, with leading zeros.
char* put_decimals(char* at, std::uint64_t fraction, int digits) noexcept {
  for (int place = digits - 1; place >= 0; --place) {
    at[place] = static_cast<char>('0' + fraction % 10);
    fraction /= 10;
  }
  return at + digits;
}

}  // namespace

char* put_count(char* at, std::uint64_t count) noexcept { return put_shortest(at, count); }

char* put_seconds(char* at, std::int64_t time_ns) noexcept {
  const std::uint64_t magnitude = distance(time_ns, 0);
  if (time_ns < 0) *at++ = '-';
  at = put_count(at, magnitude / kNsPerSecond);
  const std::uint64_t fraction = magnitude % kNsPerSecond;
  if (fraction == 0) return at;
  *at++ = '.';
  at = put_decimals(at, fraction, 9);
  while (at[-1] == '0') --at;
  return at;
}

char* put_microseconds(char* at, std::int64_t time_ns) noexcept {
  const std::uint64_t microseconds = (distance(time_ns, 0) + 500) / 1000;
  if (time_ns < 0 && microseconds > 0) *at++ = '-';
  at = put_count(at, microseconds / 1'000'000);
  *at++ = '.';
  return put_decimals(at, microseconds % 1'000'000, 6);
}

char* put_value(char* at, double value, ValueType type, std::string_view undefined) noexcept {
  if (std::isnan(value)) return std::copy(undefined.begin(), undefined.end(), at);
  if (type == ValueType::Float32) return put_shortest(at, static_cast<float>(value));
  constexpr double kLargestExact = 9007199254740992.0;  // 2^53: above it, doubles do not hold every whole number
  const bool is_whole = type != ValueType::Double64 && std::abs(value) <= kLargestExact;
  return is_whole ? put_shortest(at, static_cast<std::int64_t>(value)) : put_shortest(at, value);
}

std::string name_with_unit(const ChannelInfo& channel) {
  if (channel.unit.empty()) return channel.label;
  std::string suffix = "_" + channel.unit;
  std::ranges::transform(suffix, suffix.begin(),
                         [](char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter; });
  return channel.label.ends_with(suffix) ? channel.label : channel.label + suffix;
}

std::string tsv_cell(std::string_view text) {
  if (text.empty()) return "n/a";
  std::string cell = core::as_cell(text);
  std::ranges::replace_if(
      cell, [](char letter) { return letter == '\t' || letter == '\n' || letter == '\r'; }, ' ');
  return cell;
}

std::string main_text(const RecordedEvent& event) {
  const auto found = find_main(event);
  return found != event.values.end() ? text_of(found->second) : std::string();
}

std::string further_details(const RecordedEvent& event) {
  const auto main = find_main(event);
  return values_json(event, main != event.values.end() ? main->first : std::string());
}

std::string value_text(const RecordedEvent& event, std::string_view key) {
  const auto found = std::ranges::find(event.values, key, &Values::value_type::first);
  return found != event.values.end() ? text_of(found->second) : std::string();
}

std::int64_t to_ns(double seconds) noexcept {
  constexpr double kLargest = 9.2e9;  // seconds that fit into 64 bits of nanoseconds
  if (std::isnan(seconds)) return 0;
  return static_cast<std::int64_t>(std::llround(std::clamp(seconds, -kLargest, kLargest) * 1e9));
}

void TimeAxis::begin(const RecordedScans& scans) noexcept {
  first_scan_ = scans.first_scan.value;
  const std::int64_t stamp_ns = to_ns(scans.first_time_s - origin_s_);
  const bool follows = anchor_ && anchor_->segment == scans.segment && anchor_->scan <= first_scan_;
  if (follows && distance(predicted_ns(first_scan_), stamp_ns) <= static_cast<std::uint64_t>(kStampToleranceNs)) return;
  anchor_ = Anchor{.segment = scans.segment, .scan = first_scan_, .time_ns = stamp_ns};
}

std::int64_t TimeAxis::time_ns(std::size_t place) const noexcept { return predicted_ns(first_scan_ + place); }

std::int64_t TimeAxis::predicted_ns(std::uint64_t scan) const noexcept {
  std::int64_t time_ns = 0;
  const bool is_beyond = __builtin_add_overflow(anchor_->time_ns, rate_.time_ns({scan - anchor_->scan}), &time_ns);
  return is_beyond ? std::numeric_limits<std::int64_t>::max() : time_ns;
}

}  // namespace dts::record
