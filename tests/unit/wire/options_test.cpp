// SPDX-License-Identifier: Apache-2.0
#include "dts/wire/options.h"

#include <gtest/gtest.h>

#include <string>

namespace dts::wire {
namespace {

const google::protobuf::OneofDescriptor& commands() { return *v1::Request::descriptor()->FindOneofByName("command"); }

v1::Request request_of(const google::protobuf::FieldDescriptor* command) {
  v1::Request request;
  request.GetReflection()->MutableMessage(&request, command);
  return request;
}

TEST(Options, EveryEventHasATopic) {
  std::string retained, names;
  for (const v1::Topic& topic : event_topics()) {
    names += topic.name() + " ";
    if (topic.is_retained()) retained += topic.name() + " ";
    EXPECT_TRUE(is_event_topic(topic.name()));
  }
  EXPECT_EQ(names, "gap marker device session trigger trial reach class trial sway ");
  EXPECT_EQ(retained, "device session ");
  EXPECT_FALSE(is_event_topic("cop"));
  EXPECT_FALSE(is_event_topic(""));

  v1::Event event;
  EXPECT_EQ(topic_of(event).name(), "");
  event.mutable_movement();
  EXPECT_EQ(topic_of(event).name(), "class");
}

TEST(Options, EveryCommandHasARoleAndAnAnswer_AndEveryChangeAName) {
  std::string slow;
  for (int index = 0; index < commands().field_count(); ++index) {
    SCOPED_TRACE(commands().field(index)->name());
    const v1::Request request = request_of(commands().field(index));
    const v1::CommandRules& rules = rules_of(request);
    EXPECT_EQ(command_field(request), commands().field(index));
    EXPECT_NE(rules.role(), v1::ROLE_UNSPECIFIED);
    ASSERT_NE(answer_field(request), nullptr);
    EXPECT_EQ(answer_field(request)->name(), rules.answer());
    EXPECT_EQ(answer_field(request)->containing_oneof()->name(), "result");
    if (rules.timeout_s() > 0) slow += commands().field(index)->name() + " " + std::to_string(rules.timeout_s()) + " s, ";
    if (rules.is_change()) {
      EXPECT_NE(rules.audit(), "");
      EXPECT_GT(rules.role(), v1::ROLE_VIEWER);
    }
  }
  EXPECT_EQ(slow, "stop_session 20 s, tare 15 s, erase_subject 20 s, ");
}

TEST(Options, ARequestWithoutACommand_NeedsWhatNobodyHas) {
  const v1::Request request;
  EXPECT_EQ(command_field(request), nullptr);
  EXPECT_EQ(rules_of(request).role(), v1::ROLE_UNSPECIFIED);
  EXPECT_EQ(answer_field(request), nullptr);
}

TEST(Options, BitsNameAnEnumOfTheProtocol) {
  int fields = 0;
  for (const auto* file : {v1::Event::descriptor()->file(), v1::Request::descriptor()->file()}) {
    for (int message = 0; message < file->message_type_count(); ++message) {
      const auto* type = file->message_type(message);
      for (int index = 0; index < type->field_count(); ++index) {
        const std::string name = type->field(index)->options().GetExtension(v1::bits);
        if (name.empty()) continue;
        ++fields;
        EXPECT_NE(file->pool()->FindEnumTypeByName("dts.v1." + name), nullptr) << type->field(index)->full_name();
      }
    }
  }
  EXPECT_EQ(fields, 3);
}

}  // namespace
}  // namespace dts::wire
