// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/request_target.h"

#include <gtest/gtest.h>

#include <string>

namespace dts::gateway {
namespace {

using std::string_literals::operator""s;

TEST(RequestTarget, PathAndQueryAreDecodedOnce) {
  const auto target = parse_target("/api/a%20b/%c3%a9?x=1%2B1&y=a+b&empty");

  ASSERT_TRUE(target.has_value());
  EXPECT_EQ(target->path, "/api/a b/\xc3\xa9");
  EXPECT_EQ(target->query, (std::map<std::string, std::string>{{"x", "1+1"}, {"y", "a b"}, {"empty", ""}}));
  EXPECT_EQ(parse_target("/%252e%252e/x")->path, "/%2e%2e/x");
  EXPECT_EQ(parse_target("/...")->path, "/...");
  EXPECT_EQ(parse_target("/")->path, "/");
}

class BadTarget : public ::testing::TestWithParam<std::string> {};

TEST_P(BadTarget, IsRefused) { EXPECT_FALSE(parse_target(GetParam()).has_value()); }

INSTANTIATE_TEST_SUITE_P(All, BadTarget,
                         ::testing::Values("", "x", "*", "http://127.0.0.1/", "//a/../b", "/..", "/../etc/passwd", "/a/..", "/a/../b",
                                           "/./a", "/%2e%2e/etc/passwd", "/%2E./x", "/a%2f..%2fb", "/a\\..\\b", "/a%5c..%5cb", "/a%00.html",
                                           "/a\0b"s, "/a%0d%0aX: y", "/a%7f", "/%", "/%4", "/%zz", "/%c0%ae%c0%ae/x", "/%e0%80%af",
                                           "/%ed%a0%80", "/%f4%90%80%80", "/%80", "/%c3", "/\xff", "/a#b", "/a?x=%zz", "/a?x=1&x=2",
                                           "/a?x=%00", "/a?%c0%ae=1"));

}  // namespace
}  // namespace dts::gateway
