// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

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

TEST(DeviceUri, NoOptions_HasSchemeAndName) {
  const auto uri = DeviceUri::parse("sim:floor");

  ASSERT_TRUE(uri.has_value());
  EXPECT_EQ(uri->scheme, "sim");
  EXPECT_EQ(uri->name, "floor");
  EXPECT_TRUE(uri->options.empty());
  EXPECT_EQ(uri->text, "sim:floor");
}

TEST(DeviceUri, ManyOptions_AllTaken) {
  const auto uri = DeviceUri::parse("sim:floor?seed=7&contact=point&x_mm=-12.5");

  ASSERT_TRUE(uri.has_value());
  EXPECT_EQ(uri->options, (std::map<std::string, std::string>{{"seed", "7"}, {"contact", "point"}, {"x_mm", "-12.5"}}));
}

TEST(DeviceUri, NameIsAPath_TakenAsItIs) {
  const auto uri = DeviceUri::parse("replay:/var/lib/a b:c.xdf");

  ASSERT_TRUE(uri.has_value());
  EXPECT_EQ(uri->name, "/var/lib/a b:c.xdf");
}

TEST(DeviceUri, NoName_IsEmpty) {
  const auto uri = DeviceUri::parse("ni6008:");

  ASSERT_TRUE(uri.has_value());
  EXPECT_EQ(uri->name, "");
}

TEST(DeviceUri, ValueWithEqualsQuestionOrNothing_TakenAsItIs) {
  const auto uri = DeviceUri::parse("sim:floor?cop=a=b?c&seed=");

  ASSERT_TRUE(uri.has_value());
  EXPECT_EQ(uri->options.at("cop"), "a=b?c");
  EXPECT_EQ(uri->options.at("seed"), "");
}

TEST(DeviceUri, NoScheme_Refused) {
  EXPECT_NE(uri_refusal("floor").find("has no scheme"), std::string::npos);
  EXPECT_NE(uri_refusal("").find("has no scheme"), std::string::npos);
}

TEST(DeviceUri, SchemeIsNotAWord_Refused) {
  EXPECT_NE(uri_refusal(":floor").find("scheme"), std::string::npos);
  EXPECT_NE(uri_refusal("si m:floor").find("si m"), std::string::npos);
}

TEST(DeviceUri, OptionWithoutValue_Refused) {
  EXPECT_NE(uri_refusal("sim:floor?seed").find("\"seed\""), std::string::npos);
  EXPECT_NE(uri_refusal("sim:floor?").find("key=value"), std::string::npos);
  EXPECT_NE(uri_refusal("sim:floor?seed=1&").find("key=value"), std::string::npos);
  EXPECT_NE(uri_refusal("sim:floor?seed=1&&bits=12").find("key=value"), std::string::npos);
  EXPECT_NE(uri_refusal("sim:floor?=1").find("key=value"), std::string::npos);
}

TEST(DeviceUri, KeyTwice_Refused) { EXPECT_NE(uri_refusal("sim:floor?seed=1&seed=1").find("\"seed\" stands twice"), std::string::npos); }

TEST(DeviceUri, ControlCharacter_RefusedWithoutEchoingIt) {
  const std::string what = uri_refusal("sim:floor?seed=1\n2");

  EXPECT_NE(what.find("control character"), std::string::npos);
  EXPECT_EQ(what.find('\n'), std::string::npos);
}

TEST(DeviceUri, VeryLong_RefusedBriefly) {
  const std::string what = uri_refusal("sim:" + std::string(1'000'000, 'x'));

  EXPECT_LT(what.size(), 200U);
}

}  // namespace
}  // namespace dts::device
