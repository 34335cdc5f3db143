// SPDX-License-Identifier: Apache-2.0
#include "device/program_rights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dts::device {
namespace {

using testing::HasSubstr;

TEST(ProgramRights, NoProgramByDefault_TheErrorNamesAddressAndKey) {
  const auto refused = ProgramRights{}.check("exec:/usr/bin/board?channels=4");
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, core::ErrorCode::NotAllowed);
  EXPECT_THAT(refused.error().what, HasSubstr("exec:/usr/bin/board?channels=4"));
  EXPECT_THAT(refused.error().hint, HasSubstr("allow_exec = true under [devices]"));
  EXPECT_TRUE(ProgramRights{.are_allowed = true}.check("exec:/usr/bin/board?channels=4").has_value());
}

}  // namespace
}  // namespace dts::device
