// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/identity.h"

#include <gtest/gtest.h>

namespace dts::gateway {
namespace {

TEST(Identity, ARoleMayDoWhatTheRolesBelowItMayDo) {
  EXPECT_FALSE(may({.user = "v", .role = v1::ROLE_VIEWER}, v1::ROLE_OPERATOR));
  EXPECT_TRUE(may({.user = "o", .role = v1::ROLE_OPERATOR}, v1::ROLE_OPERATOR));
  EXPECT_TRUE(may({.user = "e", .role = v1::ROLE_ENGINEER}, v1::ROLE_OPERATOR));
  EXPECT_FALSE(may({.user = "e", .role = v1::ROLE_ENGINEER}, v1::ROLE_UNSPECIFIED));
}

}  // namespace
}  // namespace dts::gateway
