// SPDX-License-Identifier: Apache-2.0
// The normal dtsd and dtsctl over unmodified libusb, a USB DAQ that is not there, and a plate that knows where the weight stands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>

#include "usb/host_program/emulator_process.h"

namespace dts::emulator {
namespace {

using nlohmann::json;
using test::eventually;
using ::testing::HasSubstr;

constexpr double kSettleNs = 0.4e9;    // the weight is down and the filters have forgotten the time before
constexpr double kLargestRmsMm = 1.0;  // 0.13 was measured; the accuracy of platforms is the business of tests/accuracy

struct Comparison {
  int compared = 0;
  double sum_squares = 0.0;
  std::set<double> places_ml_mm;

  [[nodiscard]] double rms_mm() const { return std::sqrt(sum_squares / std::max(compared, 1)); }
};

/// true: the same weight has been at the same place for a while, and stays.
bool is_at_rest(EmulatorProcess& emulator, std::int64_t when_ns, const RigSource::Truth& now) {
  const auto before = emulator.truth_at(when_ns - static_cast<std::int64_t>(kSettleNs));
  const auto after = emulator.truth_at(when_ns + static_cast<std::int64_t>(kSettleNs));
  return before && after && before->load_n == now.load_n && after->load_n == now.load_n && before->ml_mm == now.ml_mm;
}

void compare_block(EmulatorProcess& emulator, const json& block, Comparison& result) {
  const auto first_ns = block.at("host_time_ns").get<std::int64_t>();
  const json& values = block.at("values").at(0);
  if (values.at(0).is_null()) return;
  const auto truth = emulator.truth_at(first_ns);
  ASSERT_TRUE(truth);
  if (std::isnan(truth->ml_mm) || !is_at_rest(emulator, first_ns, *truth)) return;
  const double ml_mm = values.at(0).get<double>() - truth->ml_mm;
  const double ap_mm = values.at(1).get<double>() - truth->ap_mm;
  result.sum_squares += ml_mm * ml_mm + ap_mm * ap_mm;
  ++result.compared;
  result.places_ml_mm.insert(truth->ml_mm);
}

/// The weights of the test, laid on again and again: a slow machine may start to watch late.
std::string weights_for_minutes() {
  std::string lines = "x_mm,y_mm,load_n\n";
  for (int round = 0; round < 20; ++round) lines += "40,-30,490\n-60,50,600\n0,0,400\n";
  return lines;
}

TEST(UsbEndToEndTest, TheWatchedCopFollowsTheWeightsOnThePlate) {
  RecordProperty("requirement", "COP-6");
  EmulatorProcess emulator({.scene = "sim:floor?contact=weights&weights=$DIR/weights.csv&step_on_s=3&hold_s=1.5&pause_s=0.5&ramp_s=0.2",
                            .weights = weights_for_minutes()});
  ASSERT_TRUE(eventually([&] { return emulator.is_streaming(); })) << emulator.log();

  Comparison result;
  EXPECT_TRUE(eventually([&] {
    const auto watched = emulator.ctl({"watch", "floor/cop", "--jsonl", "--count", "100", "--timeout", "60"});
    std::istringstream lines(watched.out);
    for (std::string line; std::getline(lines, line);) compare_block(emulator, json::parse(line), result);
    return result.compared > 60 && result.places_ml_mm.size() == 3;
  })) << result.compared
      << " blocks at " << result.places_ml_mm.size() << " places\n"
      << emulator.log();
  std::printf("  %d blocks compared, COP off by %.2f mm rms\n", result.compared, result.rms_mm());
  EXPECT_LT(result.rms_mm(), kLargestRmsMm);
  EXPECT_EQ(emulator.quit(), 0);
}

TEST(UsbEndToEndTest, ASessionSurvivesThePlug) {
  RecordProperty("requirement", "ACQ-5");
  EmulatorProcess emulator({.scene = "sim:floor?contact=point&step_on_s=3600"});
  ASSERT_TRUE(eventually([&] { return emulator.is_streaming(); })) << emulator.log();
  ASSERT_EQ(emulator.ctl({"session", "start", "--rig", "floor", "--protocol", "free"}).status, 0);

  const auto rig_now = [&] { return json::parse(emulator.ctl({"status", "--json"}).out).at("rigs").at(0); };
  for (int cycle = 1; cycle <= 3; ++cycle) {
    const int gaps_before = rig_now().at("gaps_total").get<int>();
    ASSERT_EQ(emulator.ask("unplug"), "ok");
    ASSERT_TRUE(eventually([&] { return !emulator.is_streaming(); })) << emulator.log();
    ASSERT_EQ(emulator.ask("plug"), "ok");
    ASSERT_TRUE(eventually([&] { return emulator.is_streaming(); })) << emulator.log();
    EXPECT_TRUE(eventually([&] { return rig_now().at("gaps_total").get<int>() > gaps_before; })) << emulator.log();
  }

  const json rig = rig_now();
  EXPECT_EQ(rig.at("session").at("state"), "running");
  // A busy machine may add a gap of its own: the emulated device or the daemon was late by more than silence is waited for.
  EXPECT_GE(rig.at("segment").get<int>(), 3);
  EXPECT_EQ(rig.at("segment"), rig.at("gaps_total"));
  EXPECT_EQ(emulator.ctl({"session", "stop"}).status, 0);
}

TEST(UsbEndToEndTest, TheSyncPulseOfASessionIsSeenInTheDataAtItsScan) {
  RecordProperty("requirement", "ACQ-18");
  EmulatorProcess emulator({.uri = "mcc:1608fs-plus?channels=0,1,2,3,4&range_v=10&sync_output_bit=0",
                            .scene = "sim:floor?contact=point&step_on_s=3600",
                            .rig_tables = "[trigger]\nchannel = 4\n[session]\nsync_pulse_ms = 200\n",
                            .wiring = {"--loop-back", "0:4"}});
  ASSERT_TRUE(eventually([&] { return emulator.is_streaming(); })) << emulator.log();
  auto subscriber = emulator.subscribe({"floor/trigger", "floor/aux"});
  std::map<std::uint64_t, float> line_v;
  std::optional<std::uint64_t> told;
  ASSERT_EQ(emulator.ctl({"session", "start", "--rig", "floor", "--protocol", "free"}).status, 0);

  const auto has_seen_the_pulse = [&] {
    const auto message = subscriber.receive(std::chrono::milliseconds(20));
    if (message && message->has_value()) {
      if (const auto* event = std::get_if<client::Event>(&**message)) told = event->body->scan();
      if (const auto* block = std::get_if<client::Block>(&**message)) {
        for (std::size_t scan = 0; scan < block->scan_count; ++scan) line_v[block->first_scan + scan] = block->column(0)[scan];
      }
    }
    return told && line_v.contains(*told) && line_v.rbegin()->first > *told + 60 && line_v.rbegin()->second < 0.5F;
  };
  ASSERT_TRUE(eventually(has_seen_the_pulse)) << emulator.log();

  EXPECT_GT(line_v[*told], 4.5F);
  EXPECT_LT(line_v[*told - 1], 0.5F);
}

TEST(UsbEndToEndTest, ThePulsesOfATrainAreTriggersAboutOnePeriodApart) {
  EmulatorProcess emulator({.uri = "mcc:1608fs-plus?channels=0,1,2,3,4&range_v=10&sync_output_bit=0",
                            .scene = "sim:floor?contact=point&step_on_s=3600",
                            .rig_tables = "[trigger]\nchannel = 4\n[session]\nsync_pulse_ms = 100\nsync_pulse_every_ms = 400\n",
                            .wiring = {"--loop-back", "0:4"}});
  ASSERT_TRUE(eventually([&] { return emulator.is_streaming(); })) << emulator.log();
  auto subscriber = emulator.subscribe({"floor/trigger"});
  std::size_t edges = 0;
  ASSERT_EQ(emulator.ctl({"session", "start", "--rig", "floor", "--protocol", "free"}).status, 0);

  const auto has_seen_three = [&] {
    const auto message = subscriber.receive(std::chrono::milliseconds(20));
    if (message && message->has_value() && std::holds_alternative<client::Event>(**message)) ++edges;
    return edges >= 3;
  };
  EXPECT_TRUE(eventually(has_seen_three)) << emulator.log();
}

TEST(UsbEndToEndTest, AnUnknownCommandIsAnsweredWithTheKnownOnes) {
  EmulatorProcess emulator({.scene = "sim:floor?contact=point"});

  EXPECT_THAT(emulator.ask("unplugg"), HasSubstr("error no command is called"));
  EXPECT_THAT(emulator.ask("fault nonsense 1"), HasSubstr("error no fault is called"));
}

}  // namespace
}  // namespace dts::emulator
