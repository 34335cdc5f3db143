// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <set>
#include <string>

namespace dts::fleet {

/// Sets every text of a message, and of the messages within, to "canary-FIELD", every number to 1. Fields of a oneof are set only if `only`
/// names one of them. Skips fields in `skipped` (full names).
inline void fill_with_canaries(google::protobuf::Message& message, const std::string& only = {},
                               const std::set<std::string>& skipped = {}) {
  using google::protobuf::FieldDescriptor;
  const auto& reflection = *message.GetReflection();
  for (int index = 0; index < message.GetDescriptor()->field_count(); ++index) {
    const FieldDescriptor* field = message.GetDescriptor()->field(index);
    const bool is_other = field->real_containing_oneof() != nullptr && field->name() != only;
    if (is_other || skipped.contains(field->full_name())) continue;
    const std::string canary = "canary-" + field->name();
    const bool is_repeated = field->is_repeated();
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_STRING:
        is_repeated ? reflection.AddString(&message, field, canary) : reflection.SetString(&message, field, canary);
        break;
      case FieldDescriptor::CPPTYPE_MESSAGE:
        fill_with_canaries(is_repeated ? *reflection.AddMessage(&message, field) : *reflection.MutableMessage(&message, field), {},
                           skipped);
        break;
      case FieldDescriptor::CPPTYPE_ENUM:
        if (!is_repeated) reflection.SetEnumValue(&message, field, 1);
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        if (!is_repeated) reflection.SetBool(&message, field, true);
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        is_repeated ? reflection.AddDouble(&message, field, 1.0) : reflection.SetDouble(&message, field, 1.0);
        break;
      case FieldDescriptor::CPPTYPE_UINT32:
        if (!is_repeated) reflection.SetUInt32(&message, field, 1);
        break;
      case FieldDescriptor::CPPTYPE_UINT64:
        if (!is_repeated) reflection.SetUInt64(&message, field, 1);
        break;
      case FieldDescriptor::CPPTYPE_INT64:
        if (!is_repeated) reflection.SetInt64(&message, field, 1);
        break;
      default: break;
    }
  }
}

/// The words "canary-..." in a text. For a message use ShortDebugString: in its bytes, a letter may follow a text.
inline std::set<std::string> canaries_in(const std::string& text) {
  std::set<std::string> found;
  for (std::size_t at = text.find("canary-"); at != std::string::npos; at = text.find("canary-", at + 1)) {
    const std::size_t end = text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_-", at);
    found.insert(text.substr(at, end == std::string::npos ? end : end - at));
  }
  return found;
}

}  // namespace dts::fleet
