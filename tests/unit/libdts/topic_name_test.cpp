// SPDX-License-Identifier: Apache-2.0
#include "../clients/libdts/topic_name.h"

#include <gtest/gtest.h>

#include <string>

namespace dts::client {
namespace {

TEST(TopicName, RigNameAndKind_AreTakenApart) {
  const auto topic = parse_topic("floor/cop");

  ASSERT_TRUE(topic.has_value());
  EXPECT_EQ(topic->rig, "floor");
  EXPECT_EQ(topic->name, "cop");
  EXPECT_EQ(topic->kind, TopicKind::Stream);
  EXPECT_EQ(parse_topic("chair/reach")->kind, TopicKind::Event);
  EXPECT_EQ(parse_topic("chair/trial")->kind, TopicKind::Event);
  EXPECT_EQ(parse_topic("dtsd/status")->kind, TopicKind::Status);
  EXPECT_EQ(parse_topic("floor/status")->kind, TopicKind::Stream) << "of a stage with that name";
}

TEST(TopicName, AnythingElse_IsRefused) {
  for (const std::string topic : {"", "floor", "/cop", "floor/", "floor/cop/x", "/"}) {
    EXPECT_FALSE(parse_topic(topic)) << topic;
  }
  EXPECT_FALSE(parse_topic(std::string(200, 'x') + "/cop"));
}

}  // namespace
}  // namespace dts::client
