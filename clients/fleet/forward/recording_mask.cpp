// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/recording_mask.h"

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "fleet/forward/event_mask.h"
#include "record/xdf/byte_codec.h"
#include "record/xdf/header_xml.h"

namespace dts::fleet::forward {
namespace {

using record::ChunkTag;

/// Facts of headers and footers that leave the clinic. All others are masked.
constexpr std::array<std::string_view, 24> kSentFacts{
    "format_version", "session_id",     "rig",        "kind",         "protocol",       "subject",
    "boot_id",        "software",       "device_uri", "device_model", "device_serial",  "firmware",
    "calibration_id", "rig_definition", "part",       "plan_seed",    "model_sha256",   "protocol_definition",
    "started_utc_ns", "duration_s",     "settle_s",   "stage_state",  "lost_s_at_most", "recovered"};
/// Elements that dtsd writes. Another one may hold anything.
constexpr std::array<std::string_view, 35> kElements{
    "?xml",      "info",         "version",         "desc",           "dts",           "fact",       "name",      "type", "channel_count",
    "source_id", "created_at",   "nominal_srate",   "channel_format", "uid",           "session_id", "hostname",  "unit", "channels",
    "channel",   "label",        "device_channel",  "minimum",        "maximum",       "resolution", "is_sensor", "rate", "is_marker",
    "delay_ns",  "sample_count", "first_timestamp", "last_timestamp", "clock_offsets", "offset",     "time",      "value"};
constexpr std::string_view kField = "field.";
constexpr std::string_view kStage = "stage";  // "stages", "stage.1"
constexpr std::string_view kFactBegin = "<fact name=\"";
constexpr std::string_view kFactEnd = "</fact>";

tl::unexpected<core::Error> unknown(const std::string& what) {
  return core::fail(core::ErrorCode::DataDamaged, what + ", which dtsd does not write", "check the recording: dtsctl session verify FILE");
}

/// Fails if the XML has an element that dtsd does not write.
core::Status check_elements(std::string_view xml) {
  for (std::size_t at = xml.find('<'); at != std::string_view::npos; at = xml.find('<', at + 1)) {
    const std::string_view rest = xml.substr(at + 1);
    const std::string_view name = rest.substr(0, rest.find_first_of(" />"));
    const bool is_end = rest.starts_with('/');
    if (!is_end && std::ranges::find(kElements, name) == kElements.end())
      return unknown("a header with <" + std::string(name.substr(0, 40)) + ">");
  }
  return {};
}

}  // namespace

bool RecordingMask::is_sent(const std::string& fact) const {
  if (fact.starts_with(kField)) return rules_.fields.contains(fact.substr(kField.size()));
  if (fact == "label" || fact == "incomplete") return rules_.labels;
  return std::ranges::find(kSentFacts, fact) != kSentFacts.end() || fact == "utc_minus_monotonic_ns" || fact.starts_with(kStage);
}

/// Masks facts in the XML from `begin` to the end of `bytes`, as record/xdf/header_xml_write.cpp writes them.
core::Status RecordingMask::mask_header(std::string& bytes, std::size_t begin) const {
  DTS_TRY(check_elements(std::string_view(bytes).substr(begin)));
  for (std::size_t at = bytes.find("<fact", begin); at != std::string::npos; at = bytes.find("<fact", at)) {
    if (bytes.compare(at, kFactBegin.size(), kFactBegin) != 0) return unknown("a fact without a name");
    const std::size_t name = at + kFactBegin.size();
    const std::size_t name_end = bytes.find('"', name);
    if (name_end == std::string::npos) return unknown("a fact with half a name");
    at = name_end + 1;
    if (bytes.compare(at, 3, " />") == 0) continue;  // empty
    if (at >= bytes.size() || bytes[at] != '>') return unknown("a fact with more than a name");
    const std::size_t end = bytes.find('<', ++at);
    if (end == std::string::npos || bytes.compare(end, kFactEnd.size(), kFactEnd) != 0) return unknown("a fact with more than a text");
    if (!is_sent(bytes.substr(name, name_end - name)))
      std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(at), bytes.begin() + static_cast<std::ptrdiff_t>(end), kMask);
    at = end;
  }
  return {};
}

/// Masks the texts of a samples chunk; `begin`: after the number of the stream. A recording has one text in a sample.
core::Status RecordingMask::mask_texts(std::string& bytes, std::size_t begin) const {
  record::ByteCursor cursor(std::string_view(bytes).substr(begin));
  std::uint64_t count = 0;
  if (!cursor.read_length(count)) return unknown("a chunk of texts without a count");
  for (std::uint64_t sample = 0; sample < count; ++sample) {
    std::uint8_t stamp = 0;
    double time_s = 0.0;
    std::uint64_t length = 0;
    std::string_view text;
    const bool is_whole = cursor.read(stamp) && (stamp == 0 || (stamp == 8 && cursor.read(time_s))) && cursor.read_length(length) &&
                          cursor.read_text(length, text);
    if (!is_whole) return unknown("a chunk of texts that ends too early");
    mask_event(std::span(bytes.data() + (text.data() - bytes.data()), text.size()), rules_);
  }
  return cursor.left().empty() ? core::Status() : unknown("a chunk of texts with bytes left over");
}

core::Status RecordingMask::append(const record::RawChunk& chunk, std::string& out) {
  const std::size_t begin = out.size() + (chunk.bytes.size() - chunk.content.size());
  std::uint32_t stream = 0;
  record::ByteCursor cursor(chunk.content);
  out.append(chunk.bytes);
  switch (static_cast<ChunkTag>(chunk.tag)) {
    case ChunkTag::FileHeader: return mask_header(out, begin);
    case ChunkTag::StreamHeader: {
      if (!cursor.read(stream)) return unknown("a stream without a number");
      DTS_TRY_ASSIGN(const auto info, record::stream_info_of_xml(cursor.left()));
      const bool is_text = info.value_type == record::ValueType::Text;
      if (is_text && info.channels.size() > 1) return unknown("a stream of several texts");
      (is_text ? text_streams_ : number_streams_).insert(stream);
      return mask_header(out, begin + sizeof(stream));
    }
    case ChunkTag::StreamFooter:
      return cursor.read(stream) ? mask_header(out, begin + sizeof(stream)) : unknown("a footer without a number");
    case ChunkTag::Samples:
      if (cursor.read(stream) && text_streams_.contains(stream)) return mask_texts(out, begin + sizeof(stream));
      return number_streams_.contains(stream) ? core::Status() : unknown("samples without a header");
    case ChunkTag::ClockOffset:
    case ChunkTag::Boundary: return {};
  }
  return unknown("a chunk with tag " + std::to_string(chunk.tag));
}

}  // namespace dts::fleet::forward
