// SPDX-License-Identifier: Apache-2.0
// The udev rule and the drivers must speak of the same products.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <set>
#include <string>

#include "device/registry.h"

namespace dts::device {
namespace {

std::string match(const usb::UsbModel& model) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), R"(ATTR{idVendor}=="%04x", ATTR{idProduct}=="%04x",)", model.vendor, model.product);
  return text.data();
}

/// The lines of the rule that match a product.
std::set<std::string> rule_lines() {
  std::ifstream file(DTS_SOURCE_DIR "/config/udev/70-dtsd.rules");
  std::set<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("ATTR{idVendor}")) lines.insert(line);
  }
  return lines;
}

TEST(UdevRules, HaveOneLineForEveryProductThatADriverKnowsAndNoOther) {
  const std::set<std::string> lines = rule_lines();
  std::set<std::string> wanted;
  for (const RegistryEntry& entry : registry()) {
    for (const usb::UsbModel& model : entry.usb_models) wanted.insert(match(model));
  }
  ASSERT_FALSE(wanted.empty());
  EXPECT_EQ(lines.size(), wanted.size());
  for (const std::string& start : wanted) {
    const auto found = lines.lower_bound(start);
    EXPECT_TRUE(found != lines.end() && found->starts_with(start)) << "no line for " << start;
  }
}

TEST(UdevRules, HaveNoCommentBehindARule) {
  // systemd 252 ignores such a line: "Invalid key/value pair, ignoring".
  for (const std::string& line : rule_lines()) EXPECT_EQ(line.find('#'), std::string::npos) << line;
}

TEST(UdevRules, GiveTheGroupAccessAndNotTheWorld) {
  for (const std::string& line : rule_lines()) {
    EXPECT_NE(line.find(R"(GROUP="dtsd", MODE="0660")"), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace dts::device
