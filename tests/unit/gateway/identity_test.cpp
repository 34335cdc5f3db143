// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/identity.h"

#include <google/protobuf/descriptor.h>
#include <gtest/gtest.h>

namespace dts::gateway {
namespace {

TEST(Identity, EveryCommandOfTheProtocolSaysWhichRoleItNeeds) {
  const auto* commands = v1::Request::descriptor()->FindOneofByName("command");
  ASSERT_NE(commands, nullptr);
  for (int index = 0; index < commands->field_count(); ++index) {
    v1::Request request;
    request.GetReflection()->MutableMessage(&request, commands->field(index));
    EXPECT_NE(role_needed(request), v1::ROLE_UNSPECIFIED) << commands->field(index)->name();
  }
}

TEST(Identity, ARoleMayWhatThoseBelowItMay) {
  v1::Request start;
  start.mutable_start_session();
  EXPECT_EQ(role_needed(start), v1::ROLE_OPERATOR);
  EXPECT_FALSE(may({.user = "v", .role = v1::ROLE_VIEWER}, v1::ROLE_OPERATOR));
  EXPECT_TRUE(may({.user = "o", .role = v1::ROLE_OPERATOR}, v1::ROLE_OPERATOR));
  EXPECT_TRUE(may({.user = "e", .role = v1::ROLE_ENGINEER}, v1::ROLE_OPERATOR));
  EXPECT_FALSE(may({.user = "e", .role = v1::ROLE_ENGINEER}, v1::ROLE_UNSPECIFIED));
}

TEST(Identity, ARequestWithoutACommandNeedsWhatNobodyHas) { EXPECT_EQ(role_needed(v1::Request()), v1::ROLE_UNSPECIFIED); }

}  // namespace
}  // namespace dts::gateway
