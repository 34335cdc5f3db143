// SPDX-License-Identifier: Apache-2.0
// The whole way, nothing being wrong: emulated U6, driver, engine, blocks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>

#include "device/labjack/u6.h"
#include "unit/device/labjack/u6_rig.h"

namespace dts::device::labjack {
namespace {

using core::ErrorCode;
using namespace test_u6;

TEST(U6Device, FourChannels100Hz_EverySampleRight) {
  Rig rig("labjack:u6?channels=0,1,2,3");
  rig.start(100, 1);
  EXPECT_EQ(rig.read_and_check(60 * 100).outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.taken, 6000U);
}

TEST(U6Device, ElevenChannels1500Hz_EverySampleRight) {
  Rig rig(kEleven);
  rig.start(1500);
  EXPECT_EQ(rig.read_and_check(60 * 1500).outcome, ReadOutcome::Scans);
  EXPECT_GE(rig.taken, 90'000U);
}

TEST(U6Device, AllInputsAtFullSpeed_EverySampleRight) {
  Rig rig("labjack:u6");
  rig.start(50'000.0 / 14.0, 256);
  ASSERT_EQ(rig.inputs.size(), 14U);
  EXPECT_EQ(rig.read_and_check(10 * 3571).outcome, ReadOutcome::Scans);
}

TEST(U6Device, LateCompletions_EverySampleRight) {
  Rig rig(kEleven);
  std::int64_t step = 0;
  rig.bus.lateness_ns = [&step] { return (step = (step * 7919 + 13) % 30) * kMillisecond; };
  rig.start(1500);
  EXPECT_EQ(rig.read_and_check(10 * 1500).outcome, ReadOutcome::Scans);
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

TEST(U6Device, SerialNumber_TheWrongUnitIsRefused) {
  Rig right(std::string(kEleven) + "&serial=360004242");
  EXPECT_TRUE(right.device->open().has_value());

  Rig wrong(std::string(kEleven) + "&serial=360004243");
  const core::Error error = open_error(wrong);
  EXPECT_EQ(error.code, ErrorCode::NotFound);
  EXPECT_NE(error.what.find("360004242"), std::string::npos) << error.what;
}

TEST(U6Device, Report_SaysWhatItIs) {
  Rig rig(kEleven, {.is_pro = true});
  ASSERT_TRUE(rig.device->open().has_value());
  std::string all;
  for (const DeviceCheck& check : rig.device->report().checks) all += check.detail + ";";
  EXPECT_NE(all.find("U6-Pro, serial number 360004242, firmware 1.45"), std::string::npos) << all;
}

TEST(U6Device, SyncOutput_Unsupported) {
  Rig rig(kEleven);
  ASSERT_TRUE(rig.device->open().has_value());
  EXPECT_EQ(rig.device->set_sync_output(true).error().code, ErrorCode::Unsupported);
}

core::Error refusal(const std::string& uri) {
  core::VirtualClock clock;
  emulator::FakeBus bus(clock);
  const physics::RigModel plate = test::floor_rig();
  const auto created = create_device(uri, {clock, plate, &bus});
  EXPECT_FALSE(created.has_value()) << uri;
  return created ? core::Error{} : created.error();
}

TEST(U6Device, WrongOptions_AreRefused) {
  EXPECT_NE(refusal("labjack:u6?channels=0,14").what.find("thermometer"), std::string::npos);
  EXPECT_EQ(refusal("labjack:u6?channels=0,16").code, ErrorCode::InvalidArgument);
  EXPECT_EQ(refusal("labjack:u6?channels=0,1&range_v=5").code, ErrorCode::InvalidArgument);
  EXPECT_EQ(refusal("labjack:u6?digital=2").code, ErrorCode::InvalidArgument);
}

TEST(U6Device, WithoutUsb_SaysSo) {
  core::VirtualClock clock;
  const physics::RigModel plate = test::floor_rig();
  const auto created = create_device("labjack:u6", {clock, plate});
  ASSERT_FALSE(created.has_value());
  EXPECT_EQ(created.error().code, ErrorCode::Unsupported);
}

}  // namespace
}  // namespace dts::device::labjack
