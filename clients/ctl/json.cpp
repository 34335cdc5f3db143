// SPDX-License-Identifier: Apache-2.0
#include "ctl/json.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include "ctl/recording_view.h"

namespace dts::ctl {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

/// Fields whose 0 means that there is no value (see the comments in the .proto files).
constexpr std::array<std::string_view, 14> kZeroMeansUnknown{
    "dts.v1.RigStatus.clock_drift_ppm",  "dts.v1.SessionInfo.duration_s",
    "dts.v1.RigStatus.measured_rate_hz", "dts.v1.RigStatus.pipeline_us_per_scan",
    "dts.v1.RigStatus.record_lag_s",     "dts.v1.DeviceInfo.minimum_rate_hz",
    "dts.v1.DeviceInfo.maximum_rate_hz", "dts.v1.TestDeviceResponse.measured_rate_hz",
    "dts.v1.ProtocolInfo.duration_s",    "dts.v1.SessionRecord.ended_utc_ns",
    "dts.v1.TrialChange.target_cm",      "dts.v1.TrialStatus.next_target_cm",
    "dts.v1.TrialStatus.remaining_s",    "dts.v1.TrialResult.target_cm"};

bool means_unknown_at_zero(const FieldDescriptor& field) {
  return std::ranges::find(kZeroMeansUnknown, field.full_name()) != kZeroMeansUnknown.end();
}

cli::Json number(double value) { return std::isfinite(value) ? cli::Json(value) : cli::Json(nullptr); }

/// Returns the value of a scalar field; null if it is undefined.
cli::Json scalar(const Message& message, const FieldDescriptor& field) {
  const Reflection& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_STRING: {
      const std::string text = reflection.GetString(message, &field);
      return text.empty() ? cli::Json(nullptr) : cli::Json(text);
    }
    case FieldDescriptor::CPPTYPE_ENUM: {
      const int value = reflection.GetEnumValue(message, &field);
      return value == 0 ? cli::Json(nullptr) : cli::Json(enumerator_word(*field.enum_type(), value));
    }
    case FieldDescriptor::CPPTYPE_DOUBLE: {
      const double value = reflection.GetDouble(message, &field);
      return value == 0.0 && means_unknown_at_zero(field) ? cli::Json(nullptr) : number(value);
    }
    case FieldDescriptor::CPPTYPE_BOOL: return reflection.GetBool(message, &field);
    case FieldDescriptor::CPPTYPE_INT32: return reflection.GetInt32(message, &field);
    case FieldDescriptor::CPPTYPE_INT64: {
      const std::int64_t value = reflection.GetInt64(message, &field);
      return value == 0 && means_unknown_at_zero(field) ? cli::Json(nullptr) : cli::Json(value);
    }
    case FieldDescriptor::CPPTYPE_UINT32: {
      const std::uint32_t value = reflection.GetUInt32(message, &field);
      const std::string& bits = field.options().GetExtension(v1::bits);
      return bits.empty() ? cli::Json(value) : cli::Json(bit_words(*field.file()->pool()->FindEnumTypeByName("dts.v1." + bits), value));
    }
    case FieldDescriptor::CPPTYPE_UINT64: return reflection.GetUInt64(message, &field);
    default: return nullptr;
  }
}

cli::Json element(const Message& message, const FieldDescriptor& field, int index) {
  const Reflection& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_MESSAGE: return to_json(reflection.GetRepeatedMessage(message, &field, index));
    case FieldDescriptor::CPPTYPE_STRING: return reflection.GetRepeatedString(message, &field, index);
    case FieldDescriptor::CPPTYPE_DOUBLE: return number(reflection.GetRepeatedDouble(message, &field, index));
    default: return nullptr;  // answers of the protocol have no other repeated scalar types
  }
}

/// Converts a map from text to text, the only map type in the protocol. Returns null for an empty one, as for an empty text.
cli::Json map_of(const Message& message, const FieldDescriptor& field) {
  const Reflection& reflection = *message.GetReflection();
  if (reflection.FieldSize(message, &field) == 0) return nullptr;
  std::map<std::string, std::string> sorted;  // the order in protobuf's maps varies
  for (int index = 0; index < reflection.FieldSize(message, &field); ++index) {
    const Message& entry = reflection.GetRepeatedMessage(message, &field, index);
    const google::protobuf::Descriptor& type = *entry.GetDescriptor();
    sorted[entry.GetReflection()->GetString(entry, type.map_key())] = entry.GetReflection()->GetString(entry, type.map_value());
  }
  cli::Json object = cli::Json::object();
  for (const auto& [key, value] : sorted) object[key] = value;
  return object;
}

cli::Json value_of(const Message& message, const FieldDescriptor& field) {
  const Reflection& reflection = *message.GetReflection();
  if (field.is_map()) return map_of(message, field);
  if (field.is_repeated()) {
    cli::Json list = cli::Json::array();
    for (int index = 0; index < reflection.FieldSize(message, &field); ++index) list.push_back(element(message, field, index));
    return list;
  }
  if (field.cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) return scalar(message, field);
  return reflection.HasField(message, &field) ? to_json(reflection.GetMessage(message, &field)) : cli::Json(nullptr);
}

/// Adds the sums of the session and of each of its parts next to the single values.
void add_counts(const v1::SessionRecord& session, cli::Json& json) {
  const auto add = [&session](const LossSum& sum, cli::Json& to) {
    if (!sum.is_unknown) {
      to["lost_scans"] = sum.lost_scans;
      to["gaps"] = sum.gaps;
    }
    to["planned_trials"] = session.planned_trials();
  };
  add(sum_of(session), json);
  json["valid_trials"] = valid_trials(session);
  for (int part = 0; part < session.parts_size(); ++part) add(sum_of(session.parts(part)), json["parts"][static_cast<std::size_t>(part)]);
}

/// Removes fields that have a meaning only together with another field.
void remove_meaningless(const Message& message, cli::Json& json) {
  if (const auto* channel = dynamic_cast<const v1::TestDeviceResponse::ChannelTest*>(&message)) {
    if (!channel->is_sensor()) json.erase("gap_mm");
  }
  if (const auto* session = dynamic_cast<const v1::SessionInfo*>(&message)) {
    if (session->session_id().empty()) {  // no session so far: no duration, no settling time
      for (const char* key : {"elapsed_s", "settle_s"}) json.erase(key);
    }
  }
  if (const auto* session = dynamic_cast<const v1::SessionRecord*>(&message)) add_counts(*session, json);
  if (const auto* part = dynamic_cast<const v1::SessionPart*>(&message); part != nullptr && part->is_loss_unknown()) json.erase("losses");
  if (const auto* reach = dynamic_cast<const v1::Reach*>(&message)) {
    const std::array<std::pair<const char*, const v1::ReachPoint*>, 3> points{
        {{"p1", &reach->p1()}, {"p2", &reach->p2()}, {"p3", &reach->p3()}}};
    for (const auto& [name, point] : points) {
      if (!std::isfinite(point->value_mm())) json.erase(name);  // not known yet, so it has no scan either
    }
  }
  if (const auto* result = dynamic_cast<const v1::TrialResult*>(&message); result != nullptr && result->expected_class() < 0) {
    json.erase("expected_class");
  }
  if (const auto* sway = dynamic_cast<const v1::Sway*>(&message)) {
    if (sway->is_preliminary()) json.erase("attempt");  // preliminary values belong to a trial, not to an attempt
    if (!sway->problem().empty()) {
      for (const char* key : {"rate_hz", "samples", "duration_s", "is_valid", "flags"}) json.erase(key);
    }
  }
  if (const auto* asked = dynamic_cast<const v1::ProtocolField*>(&message); asked != nullptr && asked->choices_size() > 0) {
    for (const char* key : {"minimum", "maximum"}) json.erase(key);  // a choice has no range
  }
}

}  // namespace

cli::Json to_json(const Message& message) {
  cli::Json json = cli::Json::object();
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int index = 0; index < type.field_count(); ++index) {
    const FieldDescriptor& field = *type.field(index);
    cli::Json value = value_of(message, field);
    if (!value.is_null()) json[field.name()] = std::move(value);
  }
  remove_meaningless(message, json);
  return json;
}

cli::Json event_json(std::string_view kind, const v1::Event& event) {
  cli::Json json{{"kind", kind}};
  const FieldDescriptor* body = event.GetReflection()->GetOneofFieldDescriptor(event, event.GetDescriptor()->FindOneofByName("body"));
  if (body != nullptr) json.update(to_json(event.GetReflection()->GetMessage(event, body)));
  return json;
}

std::string enumerator_word(const google::protobuf::EnumDescriptor& type, int number) {
  const auto* value = type.FindValueByNumber(number);
  if (value == nullptr) return "unknown";
  // The values of "DeviceState" are named "DEVICE_STATE_...".
  std::size_t prefix = 1;
  for (std::size_t index = 0; index < type.name().size(); ++index) {
    prefix += index > 0 && std::isupper(static_cast<unsigned char>(type.name()[index])) != 0 ? 2 : 1;
  }
  std::string word = value->name().substr(std::min(prefix, value->name().size()));
  std::ranges::transform(word, word.begin(), [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return word;
}

std::vector<std::string> bit_words(const google::protobuf::EnumDescriptor& type, std::uint32_t bits) {
  std::vector<std::string> words;
  for (std::uint32_t bit = 1; bit != 0; bit <<= 1U) {
    if ((bits & bit) != 0) words.push_back(enumerator_word(type, static_cast<int>(bit)));
  }
  return words;
}

std::vector<std::string> quality_words(std::uint8_t bits) { return bit_words(*v1::Quality_descriptor(), bits); }

}  // namespace dts::ctl
