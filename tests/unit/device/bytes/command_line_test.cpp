// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dts::device::bytes {
namespace {

using testing::ElementsAre;

TEST(CommandLine, BlanksSeparate_QuotesKeepThem) {
  EXPECT_THAT(split_command("/usr/bin/python3 board.py").value(), ElementsAre("/usr/bin/python3", "board.py"));
  EXPECT_THAT(split_command("  a\t b  ").value(), ElementsAre("a", "b"));
  EXPECT_THAT(split_command("a 'b c' \"d 'e'\" f'g h'i ''").value(), ElementsAre("a", "b c", "d 'e'", "fg hi", ""));
}

TEST(CommandLine, ThereIsNoShell) {
  EXPECT_THAT(split_command("a $HOME *.py `b` \\ ; c | d > e").value(),
              ElementsAre("a", "$HOME", "*.py", "`b`", "\\", ";", "c", "|", "d", ">", "e"));
}

TEST(CommandLine, NoProgramOrAnOpenQuote_IsRefused) {
  for (const char* wrong : {"", "   ", "''", "a 'b", "a \"b'"}) {
    const auto refused = split_command(wrong);
    ASSERT_FALSE(refused.has_value()) << wrong;
    EXPECT_EQ(refused.error().code, core::ErrorCode::InvalidArgument);
  }
}

}  // namespace
}  // namespace dts::device::bytes
