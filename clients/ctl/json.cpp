// SPDX-License-Identifier: Apache-2.0
#include "ctl/json.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ctl/recording_view.h"

namespace dts::ctl {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

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
    case FieldDescriptor::CPPTYPE_DOUBLE: return number(reflection.GetDouble(message, &field));
    case FieldDescriptor::CPPTYPE_BOOL: return reflection.GetBool(message, &field);
    case FieldDescriptor::CPPTYPE_INT32: return reflection.GetInt32(message, &field);
    case FieldDescriptor::CPPTYPE_INT64: return reflection.GetInt64(message, &field);
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
  if (field.has_presence() && !reflection.HasField(message, &field)) return nullptr;
  return field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE ? to_json(reflection.GetMessage(message, &field)) : scalar(message, field);
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

}  // namespace

cli::Json to_json(const Message& message) {
  cli::Json json = cli::Json::object();
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  for (int index = 0; index < type.field_count(); ++index) {
    const FieldDescriptor& field = *type.field(index);
    cli::Json value = value_of(message, field);
    if (!value.is_null()) json[field.name()] = std::move(value);
  }
  if (const auto* session = dynamic_cast<const v1::SessionRecord*>(&message)) add_counts(*session, json);
  if (const auto* part = dynamic_cast<const v1::SessionPart*>(&message); part != nullptr && part->is_loss_unknown()) json.erase("losses");
  return json;
}

cli::Json event_json(std::string_view kind, const v1::Event& event) {
  cli::Json json{{"kind", kind}};
  if (const Message* body = wire::body_of(event)) json.update(to_json(*body));
  return json;
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
