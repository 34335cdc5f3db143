// SPDX-License-Identifier: Apache-2.0
// What the daemon does with input that is wrong: a clear error or the documented behaviour, and it goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "system/daemon_process.h"

namespace dts::test {
namespace {

using ::testing::HasSubstr;

TEST(BadConfiguration, CheckConfig_ExitsTwoAndSaysWhere) {
  RecordProperty("requirement", "CFG-1");
  const DaemonProcess daemon({.daemon = "[log]\nlevl = \"info\""});

  const Finished checked = run_program({DTSD_PROGRAM, "--config", daemon.config_file(), "--check-config"});

  EXPECT_EQ(checked.status, 2);
  EXPECT_THAT(checked.err, HasSubstr("dtsd.toml:2:1: unknown key 'levl' in [log]; did you mean 'level'?"));
  EXPECT_FALSE(daemon.is_ready());
}

TEST(BadConfiguration, DeviceTriggerOrAddressThatCannotBe_ExitsTwoAndSaysIt) {
  for (const auto& [options, says] : {std::pair(DaemonProcess::Options{.device = "sim:flor"}, "dtsd.toml:5:10: [[rig]] 'floor'"),
                                      {{.acquire = "[trigger]\nchannel = 12\n"}, "trigger channel 12"},
                                      {{.daemon = "[endpoints]\ncontrol = \"tcp://0.0.0.0:5555\"\n"}, "write it under [network]"}}) {
    DaemonProcess daemon(options);
    EXPECT_FALSE(daemon.is_ready());
    EXPECT_EQ(daemon.wait(), 2);
    EXPECT_THAT(daemon.log(), HasSubstr(says));
  }
}

TEST(BadConfiguration, MissingFile_ExitsTwo) {
  const Finished finished = run_program({DTSD_PROGRAM, "--config", "/nonexistent/dtsd.toml"});

  EXPECT_EQ(finished.status, 2);
  EXPECT_THAT(finished.err, HasSubstr("/nonexistent/dtsd.toml"));
}

TEST(BadConfiguration, UnknownSwitch_ExitsTwo) { EXPECT_EQ(run_program({DTSD_PROGRAM, "--verbose"}).status, 2); }

TEST(RuntimeDirectory, InUse_SecondDaemonEndsAndTheFirstGoesOn) {
  RecordProperty("requirement", "CFG-3");
  DaemonProcess first;
  ASSERT_TRUE(first.is_ready());

  const Finished second =
      run_program({DTSD_PROGRAM, "--config", first.config_file()},
                  {"DTSD_RUNTIME_DIR=" + first.directory().string(), "DTSD_STATE_DIR=" + first.state_directory().string()});

  EXPECT_EQ(second.status, 6);
  EXPECT_THAT(second.err, HasSubstr("another dtsd already runs"));
  EXPECT_TRUE(first.control().status());
}

TEST(RuntimeDirectory, SocketOfAnotherDaemon_IsNotStolen) {
  DaemonProcess first;
  ASSERT_TRUE(first.is_ready());

  const DaemonProcess thief({.daemon = "[endpoints]\ncontrol = \"" + first.control_endpoint() + "\""});

  EXPECT_FALSE(thief.is_ready());
  EXPECT_THAT(thief.log(), HasSubstr("already listens"));
  EXPECT_TRUE(first.control().status());
}

}  // namespace
}  // namespace dts::test
