// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <tuple>

#include "device/registry.h"

namespace dts::device {
namespace {

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

// Other addresses that are none are in addresses.txt.
TEST(DeviceUri, TooLongOrWithAControlCharacter_RefusedWithoutRepeatingIt) {
  const std::string form = " (write a device as scheme:name?key=value&key=value, for example sim:floor?seed=7)";
  const auto refusal = [](const std::string& text) { return core::to_string(DeviceUri::parse(text).error()); };
  for (const char* bad : {"\n", "\x1f", "\x7f"})
    EXPECT_EQ(refusal(std::string("sim:") + bad), "device URI: contains a control character" + form);
  EXPECT_TRUE(DeviceUri::parse("sim:" + std::string(4092, 'x')).has_value());
  EXPECT_EQ(refusal("sim:" + std::string(4093, 'x')), "device \"sim:" + std::string(56, 'x') + "\": longer than 4096 characters" + form);
  EXPECT_EQ(refusal(""), "device \"\": has no scheme" + form);
  EXPECT_TRUE(DeviceUri::parse("s_-Z09: ").has_value());
}

}  // namespace
}  // namespace dts::device
