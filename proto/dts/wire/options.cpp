// SPDX-License-Identifier: Apache-2.0
#include "dts/wire/options.h"

#include <algorithm>
#include <cctype>

namespace dts::wire {

using google::protobuf::FieldDescriptor;

const std::vector<v1::Topic>& event_topics() {
  static const std::vector<v1::Topic> topics = [] {
    std::vector<v1::Topic> all;
    const auto* body = v1::Event::descriptor()->FindOneofByName("body");
    for (int index = 0; index < body->field_count(); ++index) {
      const v1::Topic& topic = body->field(index)->options().GetExtension(v1::topic);
      if (!topic.name().empty()) all.push_back(topic);
    }
    return all;
  }();
  return topics;
}

bool is_event_topic(std::string_view name) { return std::ranges::find(event_topics(), name, &v1::Topic::name) != event_topics().end(); }

const v1::Topic& topic_of(const v1::Event& event) {
  const FieldDescriptor* field = v1::Event::descriptor()->FindFieldByNumber(event.body_case());
  return field == nullptr ? v1::Topic::default_instance() : field->options().GetExtension(v1::topic);
}

std::string kind_of(const v1::Event& event) {
  const FieldDescriptor* field = v1::Event::descriptor()->FindFieldByNumber(event.body_case());
  if (field == nullptr) return {};
  const std::string& kind = field->options().GetExtension(v1::kind);
  if (!kind.empty()) return kind;
  const std::string& topic = field->options().GetExtension(v1::topic).name();
  return topic.empty() ? field->name() : topic;
}

const google::protobuf::Message* body_of(const v1::Event& event) {
  const FieldDescriptor* field = v1::Event::descriptor()->FindFieldByNumber(event.body_case());
  return field == nullptr ? nullptr : &event.GetReflection()->GetMessage(event, field);
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

const FieldDescriptor* command_field(const v1::Request& request) {
  return v1::Request::descriptor()->FindFieldByNumber(request.command_case());
}

const v1::CommandRules& rules_of(const v1::Request& request) {
  const FieldDescriptor* field = command_field(request);
  return field == nullptr ? v1::CommandRules::default_instance() : field->options().GetExtension(v1::rules);
}

const FieldDescriptor* answer_field(const v1::Request& request) {
  return v1::Response::descriptor()->FindFieldByName(rules_of(request).answer());
}

}  // namespace dts::wire
