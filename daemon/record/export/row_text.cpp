// SPDX-License-Identifier: Apache-2.0
#include "record/export/row_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>

#include "dts/wire/event_json.h"
#include "dts/wire/options.h"

namespace dts::record {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
/// Greater than the rounding error of a time stamp as large as Unix time (0.24 us), smaller than any scan.
constexpr std::int64_t kStampToleranceNs = 1'000;
/// Fields of an event's main text. The first field that the message has is used.
constexpr std::array<const char*, 5> kMainFields{"text", "step", "state", "edge", "reason"};

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
  std::string suffix = "_";
  for (const char letter : channel.unit) {
    if (letter != ' ') suffix += letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;  // "N m": mx_nm
  }
  return channel.label.ends_with(suffix) ? channel.label : channel.label + suffix;
}

std::string tsv_cell(std::string_view text) {
  if (text.empty()) return "n/a";
  std::string cell = core::as_cell(text);
  std::ranges::replace_if(
      cell, [](char letter) { return letter == '\t' || letter == '\n' || letter == '\r'; }, ' ');
  return cell;
}

EventCells cells_of(const TimedEvent& timed) {
  if (!timed.old_text.empty()) return old_cells_of(timed.old_text);
  EventCells cells{.kind = wire::kind_of(timed.event), .text = {}};
  const google::protobuf::Message* const body = wire::body_of(timed.event);
  if (body == nullptr) return cells;
  const google::protobuf::Descriptor& type = *body->GetDescriptor();
  const auto text_of = [body](const google::protobuf::FieldDescriptor& field) {
    if (field.enum_type() == nullptr) return body->GetReflection()->GetString(*body, &field);
    const int number = body->GetReflection()->GetEnumValue(*body, &field);
    return number == 0 ? std::string() : wire::enumerator_word(*field.enum_type(), number);
  };
  if (const auto* condition = type.FindFieldByName("condition")) cells.condition = text_of(*condition);
  const std::unique_ptr<google::protobuf::Message> rest(body->New());
  rest->CopyFrom(*body);
  for (const char* const name : kMainFields) {
    const auto* field = type.FindFieldByName(name);
    if (field == nullptr) continue;
    cells.text = text_of(*field);
    rest->GetReflection()->ClearField(rest.get(), field);
    break;
  }
  if (timed.event.session().is_aborted()) cells.text = "aborted";
  cells.details = wire::to_json(*rest);
  if (timed.event.has_segment_start() && timed.event.has_host_time_ns()) {  // ties the recording to the host's clock
    const std::string host_time = "{\"host_time_ns\":\"" + std::to_string(timed.event.host_time_ns()) + "\"";
    cells.details = host_time + (cells.details == "{}" ? "" : ",") + cells.details.substr(1);
  }
  if (cells.details == "{}") cells.details.clear();
  return cells;
}

TimedEvent MarkerTexts::corrected(TimedEvent timed) {
  if (!timed.event.has_marker()) return timed;
  if (const std::string* const text = corrections_->marker(part_, ++count_)) timed.event.mutable_marker()->set_text(*text);
  return timed;
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
