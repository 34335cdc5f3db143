// SPDX-License-Identifier: Apache-2.0
#include "relay/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "unit/access/key_fixture.h"

namespace dts::relay {
namespace {

using ::testing::HasSubstr;

class RelaySettings : public access::KeyFixture {
 protected:
  Settings load(const std::string& text) {
    write(folder_ + "/dtsd.toml", text);
    problems_.clear();
    return load_settings(folder_ + "/dtsd.toml", problems_);
  }
  files::Problems problems_;
};

TEST_F(RelaySettings, SharedTablesAreRead_OthersAreDtsdsOwn) {
  ::unsetenv("DTSD_STATE_DIR");
  const Settings settings = load(
      "[endpoints]\ncontrol = \"ipc:///a/c\"\ndata = \"ipc:///a/d\"\n[network]\ncontrol = \"tcp://*:1\"\ndata = \"tcp://*:2\"\n"
      "[storage]\ndirectory = \"rec\"\nwarn_below_min = \"nonsense\"\n[[rig]]\nname = 7\n");

  EXPECT_TRUE(problems_.empty());
  EXPECT_EQ(settings.local.control, "ipc:///a/c");
  EXPECT_EQ(settings.local.data, "ipc:///a/d");
  ASSERT_TRUE(settings.network);
  EXPECT_EQ(settings.network->control, "tcp://*:1");
  EXPECT_EQ(settings.network->data, "tcp://*:2");
  EXPECT_EQ(settings.key_directory, folder_ + "/rec/keys");
}

TEST_F(RelaySettings, WithoutTheTable_ThereIsNoNetwork) { EXPECT_FALSE(load("").network); }

TEST_F(RelaySettings, WrongAddress_IsAProblemWithItsPlace) {
  static_cast<void>(load("[network]\ncontrol = \"tcp://*:0\"\ndata = \"tcp://*:2\"\n"));
  ASSERT_EQ(problems_.size(), 1U);
  EXPECT_THAT(files::to_string(problems_.front()), HasSubstr("dtsd.toml:2:11: 'tcp://*:0': the port must be 1..65535"));
  static_cast<void>(load_settings(folder_ + "/nowhere.toml", problems_));
  EXPECT_EQ(problems_.size(), 2U);
}

}  // namespace
}  // namespace dts::relay
