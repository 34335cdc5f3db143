// SPDX-License-Identifier: Apache-2.0
// Trigger events, the absent DAQ, and what dtsctl says of devices, with the real daemon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "system/daemon_process.h"

namespace dts::test {
namespace {

using testing::HasSubstr;

/// The simulator's true load stands for an instrument that speaks up when somebody steps on.
constexpr int kTrueLoadChannel = 6;
constexpr float kLevelN = 300.0F;

DaemonProcess::Options stepping_on() {
  DaemonProcess::Options options;
  options.device = "sim:floor?seed=7&step_on_s=1";
  options.acquire = "[trigger]\nchannel = " + std::to_string(kTrueLoadChannel) + "\nlevel = 300\nhysteresis = 0\n";
  return options;
}

TEST(Trigger, IsToldOnceAtTheFirstScanBeyondTheLevel) {
  RecordProperty("requirement", "ACQ-17");
  DaemonProcess daemon(stepping_on());
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();
  auto subscriber = daemon.subscribe({"floor/aux", "floor/trigger"});
  std::map<std::uint64_t, float> load_n;
  std::optional<std::uint64_t> told;
  int edges = 0;
  const auto has_both = [&] { return told && load_n.contains(*told) && load_n.rbegin()->first > *told + 50; };

  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!has_both() && std::chrono::steady_clock::now() < deadline) {
    const auto message = subscriber.receive(std::chrono::milliseconds(100));
    if (!message || !message->has_value()) continue;
    if (const auto* event = std::get_if<client::Event>(&**message)) {
      ++edges;
      told = event->body->scan();
      EXPECT_EQ(event->body->trigger().edge(), v1::TRIGGER_EDGE_RISING);
      EXPECT_EQ(event->body->trigger().channel(), "true_load_n");
    } else if (const auto* block = std::get_if<client::Block>(&**message)) {
      for (std::size_t scan = 0; scan < block->scan_count; ++scan) load_n[block->first_scan + scan] = block->column(2)[scan];
    }
  }

  ASSERT_TRUE(has_both());
  EXPECT_EQ(edges, 1);
  EXPECT_GT(load_n[*told], kLevelN);
  EXPECT_LE(load_n[*told - 1], kLevelN);
}

TEST(AbsentDaq, LeavesTheDaemonUpAndSaysWhatIsMissing) {
  DaemonProcess::Options options;
  options.device = "mcc:1608fs-plus?serial=FFFFFFFF&channels=0,1,2,3";
  DaemonProcess daemon(options);
  ASSERT_TRUE(daemon.is_ready()) << daemon.log();

  ASSERT_TRUE(eventually([&] { return daemon.ctl({"status"}).out.find("is plugged in") != std::string::npos; }));
  const auto listed = nlohmann::json::parse(daemon.ctl({"--json", "device", "list"}).out);
  EXPECT_EQ(listed.at("devices").at(0).at("uri"), options.device);
  EXPECT_EQ(listed.at("devices").at(0).at("state"), "closed");
  const Finished tested = daemon.ctl({"device", "test", "floor"});
  EXPECT_NE(tested.status, 0);
  EXPECT_THAT(tested.err, HasSubstr("FFFFFFFF"));
}

}  // namespace
}  // namespace dts::test
