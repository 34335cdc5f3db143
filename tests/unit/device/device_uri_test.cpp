// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "device/registry.h"

namespace dts::device {
namespace {

std::string uri_refusal(std::string_view text) {
  const auto uri = DeviceUri::parse(text);
  if (uri) return "";
  EXPECT_EQ(uri.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_FALSE(uri.error().hint.empty());
  return uri.error().what;
}

TEST(DeviceUri, SchemeNameAndOptions_TakenAsTheyAre) {
  using Options = std::map<std::string, std::string>;
  for (const auto& [text, scheme, name, options] :
       {std::tuple{"sim:floor", "sim", "floor", Options{}},
        {"sim:floor?seed=7&contact=point&x_mm=-12.5", "sim", "floor", {{"seed", "7"}, {"contact", "point"}, {"x_mm", "-12.5"}}},
        {"replay:/var/lib/a b:c.xdf", "replay", "/var/lib/a b:c.xdf", {}},
        {"ni6008:", "ni6008", "", {}},
        {"sim:floor?cop=a=b?c&seed=", "sim", "floor", {{"cop", "a=b?c"}, {"seed", ""}}}}) {
    const auto uri = DeviceUri::parse(text);
    ASSERT_TRUE(uri.has_value()) << text;
    EXPECT_EQ(uri->text, text);
    EXPECT_EQ(uri->scheme, scheme);
    EXPECT_EQ(uri->name, name);
    EXPECT_EQ(uri->options, options);
  }
}

TEST(DeviceUri, WhatIsNone_RefusedWithTheReason) {
  for (const auto& [text, reason] : {std::pair{"floor", "has no scheme"},
                                     {"", "has no scheme"},
                                     {":floor", "scheme"},
                                     {"si m:floor", "si m"},
                                     {"sim:floor?seed", "\"seed\""},
                                     {"sim:floor?", "key=value"},
                                     {"sim:floor?seed=1&", "key=value"},
                                     {"sim:floor?seed=1&&bits=12", "key=value"},
                                     {"sim:floor?=1", "key=value"},
                                     {"sim:floor?seed=1&seed=1", "\"seed\" stands twice"},
                                     {"sim:floor?seed=1\n2", "control character"}}) {
    EXPECT_NE(uri_refusal(text).find(reason), std::string::npos) << text << ": " << uri_refusal(text);
    EXPECT_EQ(uri_refusal(text).find('\n'), std::string::npos);
  }
  EXPECT_LT(uri_refusal("sim:" + std::string(1'000'000, 'x')).size(), 200U);
}

}  // namespace
}  // namespace dts::device
