// SPDX-License-Identifier: Apache-2.0
#include "dts/wire/options.h"

#include <algorithm>

namespace dts::wire {

using google::protobuf::FieldDescriptor;

const std::vector<v1::Topic>& event_topics() {
  static const std::vector<v1::Topic> topics = [] {
    std::vector<v1::Topic> all;
    const auto* body = v1::Event::descriptor()->FindOneofByName("body");
    for (int index = 0; index < body->field_count(); ++index) all.push_back(body->field(index)->options().GetExtension(v1::topic));
    return all;
  }();
  return topics;
}

bool is_event_topic(std::string_view name) { return std::ranges::find(event_topics(), name, &v1::Topic::name) != event_topics().end(); }

const v1::Topic& topic_of(const v1::Event& event) {
  const FieldDescriptor* field = v1::Event::descriptor()->FindFieldByNumber(event.body_case());
  return field == nullptr ? v1::Topic::default_instance() : field->options().GetExtension(v1::topic);
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
