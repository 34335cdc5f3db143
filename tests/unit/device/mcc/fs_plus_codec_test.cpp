// SPDX-License-Identifier: Apache-2.0
// Bytes, rates and calibration of MCC's FS-Plus family, against values worked out by hand.
#include <gtest/gtest.h>

#include <bit>
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

TEST(FsPlusStart, EachForm_ItsBytesWithoutInhibitingTheStallOnOverrun) {
  // 26666 = 0x682A; options: immediate 1, SYNC out 2, trigger 2 << 2; bit 7 would inhibit the stall
  EXPECT_EQ(encode_start(StartForm::TenBytes,
                         {.period = 26'666, .mask = 0x0F, .is_immediate = true, .trigger = Trigger::Falling, .sync = SyncPin::Output}),
            (Bytes{0, 0, 0, 0, 0x2A, 0x68, 0, 0, 0x0F, 0x0B}));
  EXPECT_EQ(encode_start(StartForm::TenBytes, {.period = 26'666, .mask = 0xFF, .sync = SyncPin::Input}),
            (Bytes{0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0}));  // clocked by SYNC
  // bit 1 would be "differential": a SYNC output must not become that
  EXPECT_EQ(encode_start(StartForm::FourteenBytes, {.period = 0x01020304, .mask = 0x81, .trigger = Trigger::Low, .sync = SyncPin::Output}),
            (Bytes{0, 0, 0, 0, 0, 0, 0, 0, 4, 3, 2, 1, 0x81, 0x10}));
  EXPECT_EQ(encode_start(StartForm::TwelveBytes, {.period = 5832, .mask = 0xFF, .is_immediate = true}),
            (Bytes{0, 0, 0, 0, 0xC8, 0x16, 0, 0, 0xFF, 1, 0, 0}));
  EXPECT_EQ(encode_start(StartForm::TwelveBytes, {.period = 5832, .mask = 1, .trigger = Trigger::High}),
            (Bytes{0, 0, 0, 0, 0xC8, 0x16, 0, 0, 1, 0, 1, 2}));
}

TEST(FsPlusRate, Simultaneous_PeriodIsOneScan) {
  const FsPlusModel& model = usb_1608fs_plus();

  EXPECT_EQ(pace(model, 8, hz(1500)).period, 26'666U);
  EXPECT_EQ(pace(model, 8, hz(1500)).rate, *core::Rate::create(40'000'000, 26'667));

  EXPECT_EQ(pace(model, 4, hz(100)).period, 399'999U);
  EXPECT_EQ(pace(model, 4, hz(100)).rate, hz(100));
  EXPECT_EQ(pace(model, 1, hz(1000)).rate, hz(1000));
}

TEST(FsPlusRate, Multiplexed_PeriodIsOneConversion) {
  // 70 MHz / (1500 * 8) = 5833.33: 5833 ticks per conversion, 46664 per scan
  EXPECT_EQ(pace(model_of(0x0113), 8, hz(1500)).period, 5832U);
  EXPECT_EQ(pace(model_of(0x0113), 8, hz(1500)).rate, *core::Rate::create(70'000'000, 46'664));
  EXPECT_EQ(pace(model_of(0x00E8), 4, hz(100)).period, 149'999U);
  EXPECT_EQ(pace(model_of(0x00E8), 4, hz(100)).rate, hz(100));
}

TEST(FsPlusRate, ExactRate_IsItsOwnNearestAndNeverTheExternalClock) {
  for (const FsPlusModel& model : fs_plus_models()) {
    for (const double wanted : {1.0, 99.7, 1500.0, 3333.3}) {
      const Pacing once = pace(model, 7, hz(wanted));
      EXPECT_EQ(pace(model, 7, once.rate).period, once.period) << model.usb.name << " at " << wanted;
    }
    EXPECT_GT(pace(model, 1, *core::Rate::create(1'000'000'000, 1)).period, 0U);
  }
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

TEST(Codes, LittleEndianBackToBack_HalfACodeOrTooLargeAOneIsDamage) {
  struct Row {
    Bytes bytes;
    std::size_t room;
    std::uint16_t highest;
    std::vector<std::uint16_t> codes;
    bool is_damaged;
  };
  const std::vector<Row> rows = {{{0x34, 0x12, 0xFF, 0xFF}, 4, 0xFFFF, {0x1234, 0xFFFF}, false},
                                 {{1, 0, 2}, 4, 0xFFFF, {1}, true},
                                 {{1, 0, 2, 0, 3, 0}, 2, 0xFFFF, {1, 2}, false},  // the rest is for the next call
                                 {{0xFF, 0x0F, 0x00, 0x10}, 2, 0x0FFF, {0x0FFF}, true}};
  for (const Row& row : rows) {
    std::vector<std::uint16_t> codes(row.room);
    const CodesRead read = read_codes(row.bytes, codes, row.highest);
    codes.resize(read.codes);
    EXPECT_EQ(codes, row.codes);
    EXPECT_EQ(read.is_damaged, row.is_damaged);
    EXPECT_TRUE(row.is_damaged || read.bytes == 2 * row.codes.size()) << read.bytes;
  }
}

TEST(TransferChoice, SlowScansOnePacketEachOthersInBlocksOfTenMillisecondsOrOfTheLatency) {
  struct Row {
    double rate_hz;
    std::size_t channels;
    std::int64_t latency_ms;
    bool must_use_large_packets;
    bool is_immediate;
    std::size_t transfer_bytes;
    std::size_t transfer_count;
    std::int64_t transfer_period_ns;
  };
  for (const Row& row : {Row{100, 4, 20, false, true, 64, 50, 10'000'000},  // a packet of 32 codes would take 80 ms
                         Row{100, 4, 79, false, true, 64, 50, 10'000'000}, Row{100, 4, 80, false, false, 64, 8, 80'000'000},
                         Row{100, 4, 20, true, false, 64, 8, 80'000'000}, Row{1000, 1, 20, false, true, 64, 500, 1'000'000},
                         Row{1001, 1, 20, false, false, 64, 16, 31'968'032}, Row{10, 31, 20, false, true, 64, 8, 100'000'000},
                         Row{10, 32, 20, false, false, 64, 8, 100'000'000}, Row{1500, 8, 20, false, false, 192, 63, 8'000'000},
                         Row{1500, 8, 6, false, false, 128, 94, 5'333'333}, Row{1500, 8, 1, false, false, 64, 188, 2'666'667},
                         Row{50'000, 8, 20, false, false, 8000, 50, 10'000'000}, Row{500'000, 8, 20, false, false, 16'384, 245, 2'048'000},
                         Row{500'000, 8, 0, false, false, 64, 512, 8'000}}) {
    const TransferChoice choice = choose_transfers(
        {.scan_hz = row.rate_hz, .channels = row.channels, .packet_bytes = 64},
        {.rate = hz(row.rate_hz), .latency_ns = row.latency_ms * 1'000'000, .must_use_large_packets = row.must_use_large_packets});
    SCOPED_TRACE(std::to_string(row.rate_hz) + " Hz, " + std::to_string(row.latency_ms) + " ms");
    EXPECT_EQ(choice.is_immediate, row.is_immediate);
    EXPECT_EQ(choice.transfer_bytes, row.transfer_bytes);
    EXPECT_EQ(choice.transfer_count, row.transfer_count);
    EXPECT_EQ(choice.transfer_period_ns, row.transfer_period_ns);
  }
}

}  // namespace
}  // namespace dts::device::mcc
