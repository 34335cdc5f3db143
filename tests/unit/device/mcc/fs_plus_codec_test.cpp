// SPDX-License-Identifier: Apache-2.0
// Bytes, rates and calibration of MCC's FS-Plus family, against values worked out by hand.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "device/mcc/calibration.h"
#include "device/mcc/control.h"
#include "device/mcc/description.h"
#include "device/mcc/fs_plus_models.h"
#include "device/mcc/transfer_choice.h"

namespace dts::device::mcc {
namespace {

using Bytes = std::vector<std::uint8_t>;

const FsPlusModel& model_of(std::uint16_t product) {
  for (const FsPlusModel& model : fs_plus_models()) {
    if (model.usb.product == product) return model;
  }
  ADD_FAILURE() << "no product " << product;
  return usb_1608fs_plus();
}

core::Rate hz(double value) { return *core::Rate::from_hz(value); }

std::vector<std::uint8_t> record(float slope, float offset) {
  Bytes bytes;
  append_u32(bytes, std::bit_cast<std::uint32_t>(slope));
  append_u32(bytes, std::bit_cast<std::uint32_t>(offset));
  return bytes;
}

TEST(FsPlusStart, Usb1608_TenBytes) {
  const StartCommand command{.period = 26'666, .mask = 0x0F, .is_immediate = true, .trigger = Trigger::Falling, .sync = SyncPin::Output};

  // 26666 = 0x682A; options: immediate 1, SYNC out 2, trigger 2 << 2
  EXPECT_EQ(encode_start(StartForm::TenBytes, command), (Bytes{0, 0, 0, 0, 0x2A, 0x68, 0, 0, 0x0F, 0x0B}));
}

TEST(FsPlusStart, Usb1608_ClockedBySync_PeriodZeroAndNoSyncOutput) {
  const StartCommand command{.period = 26'666, .mask = 0xFF, .sync = SyncPin::Input};

  EXPECT_EQ(encode_start(StartForm::TenBytes, command), (Bytes{0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0}));
}

TEST(FsPlusStart, Usb1208_FourteenBytesSingleEnded) {
  const StartCommand command{.period = 0x01020304, .mask = 0x81, .trigger = Trigger::Low, .sync = SyncPin::Output};

  // bit 1 would be "differential": a SYNC output must not become that
  EXPECT_EQ(encode_start(StartForm::FourteenBytes, command), (Bytes{0, 0, 0, 0, 0, 0, 0, 0, 4, 3, 2, 1, 0x81, 0x10}));
}

TEST(FsPlusStart, Usb20x_TwelveBytesTriggerBehind) {
  EXPECT_EQ(encode_start(StartForm::TwelveBytes, {.period = 5832, .mask = 0xFF, .is_immediate = true}),
            (Bytes{0, 0, 0, 0, 0xC8, 0x16, 0, 0, 0xFF, 1, 0, 0}));
  EXPECT_EQ(encode_start(StartForm::TwelveBytes, {.period = 5832, .mask = 1, .trigger = Trigger::High}),
            (Bytes{0, 0, 0, 0, 0xC8, 0x16, 0, 0, 1, 0, 1, 2}));
}

TEST(FsPlusStart, NoForm_InhibitsTheStallOnOverrun) {
  for (const StartForm form : {StartForm::TenBytes, StartForm::FourteenBytes, StartForm::TwelveBytes}) {
    const std::size_t options_at = form == StartForm::FourteenBytes ? 13 : 9;
    EXPECT_EQ(encode_start(form, {.period = 1, .mask = 0xFF, .is_immediate = true, .trigger = Trigger::Low})[options_at] & 0x80, 0);
  }
}

TEST(FsPlusRate, Simultaneous_PeriodIsOneScan) {
  const FsPlusModel& model = usb_1608fs_plus();

  EXPECT_EQ(pace(model, 8, hz(1500)).period, 26'666U);
  EXPECT_EQ(pace(model, 8, hz(1500)).rate, *core::Rate::create(40'000'000, 26'667));
  EXPECT_NEAR(pace(model, 8, hz(1500)).rate.hz(), 1499.98125, 1e-5);
  EXPECT_EQ(pace(model, 4, hz(100)).period, 399'999U);
  EXPECT_EQ(pace(model, 4, hz(100)).rate, hz(100));
  EXPECT_EQ(pace(model, 1, hz(1000)).rate, hz(1000));
}

TEST(FsPlusRate, Multiplexed_PeriodIsOneConversion) {
  // 70 MHz / (1500 * 8) = 5833.33: 5833 ticks per conversion, 46664 per scan
  EXPECT_EQ(pace(model_of(0x0113), 8, hz(1500)).period, 5832U);
  EXPECT_EQ(pace(model_of(0x0113), 8, hz(1500)).rate, *core::Rate::create(70'000'000, 46'664));
  EXPECT_NEAR(pace(model_of(0x0113), 8, hz(1500)).rate.hz(), 1500.0857, 1e-4);
  EXPECT_EQ(pace(model_of(0x00E8), 4, hz(100)).period, 149'999U);
}

TEST(FsPlusRate, ExactRate_IsItsOwnNearest) {
  for (const FsPlusModel& model : fs_plus_models()) {
    for (const double wanted : {1.0, 99.7, 1500.0, 3333.3}) {
      const Pacing once = pace(model, 7, hz(wanted));
      EXPECT_EQ(pace(model, 7, once.rate).period, once.period) << model.usb.name << " at " << wanted;
    }
  }
}

TEST(FsPlusRate, Period_NeverBecomesTheExternalClock) {
  EXPECT_GT(pace(usb_1608fs_plus(), 1, *core::Rate::create(1'000'000'000, 1)).period, 0U);
}

TEST(FsPlusModels, Range_HasItsCode) {
  EXPECT_EQ(usb_1608fs_plus().range_code(10.0), 0);
  EXPECT_EQ(usb_1608fs_plus().range_code(5.0), 1);
  EXPECT_EQ(usb_1608fs_plus().range_code(2.0), 3);
  EXPECT_EQ(usb_1608fs_plus().range_code(1.0), 5);
}

TEST(Calibration, Volts_ByTheVendorsFormula) {
  const auto found = decode_calibration(record(1.01F, -300.0F), 16, "ch0");
  ASSERT_TRUE(found.has_value());

  const VoltageLine line = voltage_line(*found, 5.0, 16);

  // (40000 * 1.01 - 300) * 10 / 65536 - 5
  EXPECT_NEAR(line.at(40'000), 1.1187744, 1e-6);
  EXPECT_NEAR(voltage_line({}, 10.0, 12).at(2048), 0.0, 1e-12);
  EXPECT_NEAR(voltage_line({}, 10.0, 12).at(0), -10.0, 1e-12);
}

TEST(Calibration, Unbelievable_IsDamaged) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<Bytes> records = {record(nan, 0),       record(1, infinity), record(0, 0),      record(-1, 0), record(0.94F, 0),
                                      record(1.06F, -1966), record(1, 1'025),    record(1, -1'025), Bytes(8, 0xFF)};

  for (const Bytes& bytes : records) {
    const auto found = decode_calibration(bytes, 16, "ch3");
    ASSERT_FALSE(found.has_value());
    EXPECT_EQ(found.error().code, core::ErrorCode::DataDamaged);
    EXPECT_NE(found.error().what.find("ch3"), std::string::npos);
  }
  EXPECT_FALSE(decode_calibration(Bytes(7, 0x3F), 16, "ch3").has_value());
  EXPECT_TRUE(decode_calibration(record(1, 1'023), 16, "ch3").has_value());
}

TEST(Codes, LittleEndianBackToBack) {
  const Bytes bytes = {0x34, 0x12, 0xFF, 0xFF};
  std::vector<std::uint16_t> codes(4);

  const CodesRead read = read_codes(bytes, codes, 0xFFFF);

  EXPECT_EQ(read.bytes, 4U);
  EXPECT_EQ(read.codes, 2U);
  EXPECT_FALSE(read.is_damaged);
  EXPECT_EQ(codes[0], 0x1234);
  EXPECT_EQ(codes[1], 0xFFFF);
}

TEST(Codes, HalfACodeAtTheEnd_IsDamage) {
  const Bytes bytes = {1, 0, 2};
  std::vector<std::uint16_t> codes(4);

  const CodesRead read = read_codes(bytes, codes, 0xFFFF);

  EXPECT_EQ(read.bytes, 3U);
  EXPECT_EQ(read.codes, 1U);
  EXPECT_TRUE(read.is_damaged);
}

TEST(Codes, FullBuffer_LeavesTheRestForTheNextCall) {
  const Bytes bytes = {1, 0, 2, 0, 3, 0};
  std::vector<std::uint16_t> codes(2);

  const CodesRead read = read_codes(bytes, codes, 0xFFFF);

  EXPECT_EQ(read.bytes, 4U);
  EXPECT_FALSE(read.is_damaged);
}

TEST(Codes, MoreThanTheConverterCanGive_IsDamage) {
  const Bytes bytes = {0xFF, 0x0F, 0x00, 0x10};
  std::vector<std::uint16_t> codes(2);

  const CodesRead read = read_codes(bytes, codes, 0x0FFF);

  EXPECT_EQ(read.codes, 1U);
  EXPECT_TRUE(read.is_damaged);
}

TransferChoice choose(double rate_hz, std::size_t channels, std::int64_t latency_ms, bool must_use_large_packets = false) {
  return choose_transfers({.scan_hz = rate_hz, .channels = channels, .packet_bytes = 64},
                          {.rate = hz(rate_hz), .latency_ns = latency_ms * 1'000'000, .must_use_large_packets = must_use_large_packets});
}

TEST(TransferChoice, SlowScan_OnePacketPerScan) {
  const TransferChoice choice = choose(100, 4, 20);  // a packet of 32 codes would take 80 ms

  EXPECT_TRUE(choice.is_immediate);
  EXPECT_EQ(choice.transfer_bytes, 64U);
  EXPECT_EQ(choice.transfer_period_ns, 10'000'000);
  EXPECT_EQ(choice.transfer_count, 50U);  // half a second
}

TEST(TransferChoice, PatientReader_BlocksEvenWhenSlow) {
  EXPECT_FALSE(choose(100, 4, 80).is_immediate);
  EXPECT_TRUE(choose(100, 4, 79).is_immediate);
}

TEST(TransferChoice, FastScan_BlocksOfTenMilliseconds) {
  const TransferChoice choice = choose(1500, 8, 20);  // 2.67 ms per packet

  EXPECT_FALSE(choice.is_immediate);
  EXPECT_EQ(choice.transfer_bytes, 192U);
  EXPECT_EQ(choice.transfer_period_ns, 8'000'000);
  EXPECT_EQ(choice.transfer_count, 63U);
}

TEST(TransferChoice, ShortLatency_FewerPacketsPerTransfer) {
  EXPECT_EQ(choose(1500, 8, 6).transfer_bytes, 128U);
  EXPECT_EQ(choose(1500, 8, 1).transfer_bytes, 64U);
}

TEST(TransferChoice, AboveOneKilohertz_NeverImmediate) {
  EXPECT_TRUE(choose(1000, 1, 20).is_immediate);
  EXPECT_FALSE(choose(1001, 1, 20).is_immediate);
}

TEST(TransferChoice, OverrunBefore_Blocks) { EXPECT_FALSE(choose(100, 4, 20, true).is_immediate); }

TEST(TransferChoice, FullSpeedOfTheDevice_HalfASecondInBoundedMemory) {
  const TransferChoice choice = choose(50'000, 8, 20);

  EXPECT_EQ(choice.transfer_bytes, 8000U);
  EXPECT_EQ(choice.transfer_bytes % 64, 0U);
  EXPECT_GE(static_cast<std::int64_t>(choice.transfer_count) * choice.transfer_period_ns, 500'000'000);
}

}  // namespace
}  // namespace dts::device::mcc
