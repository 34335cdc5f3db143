// SPDX-License-Identifier: Apache-2.0
// The whole way, nothing being wrong: emulated U6, driver, engine, blocks.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "device/labjack/u6.h"
#include "device/labjack/u6_timing.h"
#include "unit/device/labjack/u6_rig.h"

namespace dts::device::labjack {
namespace {

using core::ErrorCode;
using namespace test_u6;

TEST(U6Device, AnyScan_EverySampleRightHoweverLateTheHost) {
  struct Row {
    const char* uri;
    double rate_hz;
    std::size_t block_scans;
  };
  for (const Row& row : {Row{"labjack:u6?channels=0,1,2,3", 100, 1}, Row{kEleven, 1500, 64}, Row{"labjack:u6", 50'000.0 / 14.0, 256}}) {
    SCOPED_TRACE(row.uri);
    for (const bool is_late : {false, true}) {
      Rig rig(row.uri);
      std::int64_t step = 0;
      if (is_late) rig.bus.lateness_ns = [&step] { return (step = (step * 7919 + 13) % 30) * kMillisecond; };
      rig.start(row.rate_hz, row.block_scans);
      EXPECT_EQ(rig.read_and_check(static_cast<std::uint64_t>(10 * row.rate_hz)).outcome, ReadOutcome::Scans);
    }
  }
}

TEST(U6Device, HostAwayForHalfASecond_LosesNothingHoweverShortTheLatency) {
  for (const double rate_hz : {100.0, 1500.0, 1999.0}) {
    for (const std::size_t block_scans : {1U, 64U}) {
      Rig rig("labjack:u6?channels=0,1,2,3");
      rig.start(rate_hz, block_scans);
      const std::int64_t latency_ns = std::min(rig.rate.time_ns({block_scans}), 25 * kMillisecond);
      const std::int64_t transfer_ns = pack(rig.rate, 4, latency_ns, false).transfer_period_ns;
      EXPECT_GE(rig.bus.transfers_in_flight() * transfer_ns, 450 * kMillisecond) << rate_hz << " Hz, blocks of " << block_scans;
    }
  }
}

TEST(U6Device, EachRange_OwnCalibration) {
  Rig rig("labjack:u6?channels=0,1,2,3&range_v=10,1,0.1,0.01", {}, [](double time_s, std::span<double> volts) {
    const double part = std::sin(time_s);
    for (std::size_t i = 0; i < volts.size(); ++i) volts[i] = 0.9 * kRangesV[i % 4] * part;
  });
  rig.start(100);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  for (std::size_t gain = 0; gain < 4; ++gain) {
    for (std::size_t i = 0; i < rig.block.count(); ++i) {
      const double time_s = static_cast<double>(i) / 100.0 + static_cast<double>(gain) * kSkewS;
      EXPECT_NEAR(rig.block.column(gain)[i], 0.9 * kRangesV[gain] * std::sin(time_s), 0.51 * U6Emulator::step_v(gain)) << gain;
    }
  }
}

TEST(U6Device, BeyondTheRange_Rail) {
  Rig rig("labjack:u6?channels=0,1,2&range_v=1", {}, [](double, std::span<double> volts) {
    volts[0] = 5.0;
    volts[1] = -5.0;
    volts[2] = 0.9;
  });
  rig.start(100);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.block.quality(0)[0], core::quality::kRail);
  EXPECT_EQ(rig.block.quality(1)[0], core::quality::kRail);
  EXPECT_EQ(rig.block.quality(2)[0], 0);
}

TEST(U6Device, DigitalWord_SyncLineInsideEachScan) {
  Rig rig("labjack:u6?channels=0,1&digital=1&marker=15&marker_v=0", {}, [](double time_s, std::span<double> volts) {
    volts[0] = volts[1] = 1.0;
    volts[U6Emulator::kFio0] = time_s < 0.105 ? 0.0 : 3.3;
  });
  const auto& channels = rig.device->describe().channels;
  ASSERT_EQ(channels.size(), 4U);
  EXPECT_EQ(channels[2].name, "digital");
  EXPECT_EQ(channels[2].unit, "");
  EXPECT_EQ(channels[2].role, ChannelRole::Auxiliary);
  EXPECT_EQ(channels[3].name, "ch15");
  EXPECT_EQ(channels[3].role, ChannelRole::Marker);
  rig.start(100, 20);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  ASSERT_EQ(rig.block.count(), 20U);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(rig.block.column(2)[i], i < 11 ? 0xFFFE : 0xFFFF) << i;
}

TEST(U6Device, ExactRate_IsWhatStartGives) {
  Rig rig(kEleven);
  const auto exact = rig.device->exact_rate(test::rate_of(1499.99));
  ASSERT_TRUE(exact.has_value());
  EXPECT_EQ(*exact, *core::Rate::create(1500, 1));
  rig.start(1499.99);
  EXPECT_EQ(rig.rate, *exact);
  EXPECT_EQ(rig.device->exact_rate(test::rate_of(4600)).error().code, ErrorCode::InvalidArgument);
}

TEST(U6Device, TwoUnits_TheOneWithTheSerialNumber) {
  Rig rig("labjack:u6?channels=0&serial=370000001");
  const core::Error error = open_error(rig);
  EXPECT_EQ(error.code, ErrorCode::NotFound);
  EXPECT_NE(error.hint.find("360004242"), std::string::npos) << error.hint;
  U6Emulator second([](double, std::span<double> volts) { volts[0] = 7.0; }, {.serial = 370'000'001});
  rig.bus.plug(second);
  rig.start(100);
  EXPECT_EQ(rig.device->report().serial, "370000001");
  EXPECT_EQ(rig.device->set_sync_output(true).error().code, ErrorCode::Unsupported);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_NEAR(rig.block.column(0)[0], 7.0, U6Emulator::step_v(0));
  EXPECT_FALSE(rig.unit.is_streaming());
  rig.device->close();
  rig.bus.unplug(second);
}

TEST(U6Device, Report_SaysWhatItIs) {
  Rig rig(kEleven, {.is_pro = true, .firmware_minor = 5});
  ASSERT_TRUE(rig.device->open().has_value());
  const DeviceReport report = rig.device->report();
  EXPECT_EQ(report.serial, "360004242");
  EXPECT_EQ(report.firmware, "1.05");
  std::string all;
  for (const DeviceCheck& check : report.checks) all += check.detail + ";";
  EXPECT_NE(all.find("U6-Pro"), std::string::npos) << all;
}

}  // namespace
}  // namespace dts::device::labjack
