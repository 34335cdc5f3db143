// SPDX-License-Identifier: Apache-2.0
#include "../clients/libdts/topic_name.h"

#include <gtest/gtest.h>

#include <string>

namespace dts::client {
namespace {

TEST(TopicName, RigNameAndKind_AreTakenApart) {
  const auto expect = [](const std::string& rig, const std::string& name, TopicKind kind) {
    const std::string text = rig + "/" + name;
    const auto topic = parse_topic(text);
    ASSERT_TRUE(topic.has_value()) << text;
    EXPECT_EQ(topic->rig, rig);
    EXPECT_EQ(topic->name, name);
    EXPECT_EQ(topic->kind, kind);
  };
  for (const char* stream : {"raw", "filtered", "deflection", "cop", "transient", "aux", "force", "status"})
    expect("floor", stream, TopicKind::Stream);
  for (const std::string event : {"gap", "marker", "trigger", "device", "session", "trial", "reach", "class", "sway"})
    expect("chair", event, TopicKind::Event);
  expect("dtsd", "status", TopicKind::Status);
  expect(std::string(124, 'x'), "cop", TopicKind::Stream);
}

TEST(TopicName, AnythingElse_IsRefused) {
  for (const std::string& topic : {std::string(), std::string("/"), std::string("floor"), std::string("/cop"), std::string("floor/"),
                                   std::string("floor/cop/x"), std::string(125, 'x') + "/cop"}) {
    EXPECT_FALSE(parse_topic(topic)) << topic;
  }
}

}  // namespace
}  // namespace dts::client
