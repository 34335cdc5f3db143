// SPDX-License-Identifier: Apache-2.0
// USB-1608G, 1608GX and 1608GX-2AO: whole devices over an emulated unit and a virtual clock.
#include "device/mcc/usb1608g.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "unit/device/mcc/mcc_bench.h"
#include "unit/device/sim_rig.h"
#include "usb/emulator/usb1608g_emulator.h"

namespace dts::device::mcc {
namespace {

using core::GapReason;
using device::test::temporary_path;
using emulator::Usb1608gEmulator;
using test::Bench;
using test::kMillisecond;
using test::kSecond;
using test::moving_source;
using test::Reading;

using Bytes = std::vector<std::uint8_t>;

/// A file as long as an FPGA image.
class ImageFile {
 public:
  explicit ImageFile(std::size_t bytes = 73'829) : path_(temporary_path(std::to_string(bytes) + ".rbf")) {
    std::ofstream(path_, std::ios::binary) << std::string(bytes, '\x5A');
  }
  ~ImageFile() { std::remove(path_.c_str()); }
  ImageFile(const ImageFile&) = delete;
  ImageFile& operator=(const ImageFile&) = delete;
  [[nodiscard]] std::string uri(const std::string& rest = "") const { return "mcc:1608g?fpga=" + path_ + rest; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

Usb1608gEmulator unit_g(bool is_high_speed = true) { return {0x0110, "0123ABCD", moving_source(), is_high_speed}; }

TEST(Usb1608g, TwelveChannelsAt1500Hz_EverySampleRight) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  Bench bench(image.uri("&channels=15,3,8,0,1,2,4,5,6,7,12,11"), unit);
  bench.start(1500);

  const Reading reading = bench.read(15'000, Usb1608gEmulator::kSkewS);

  EXPECT_EQ(reading.wrong, 0U);
  EXPECT_GE(reading.scans, 15'000U);
  EXPECT_EQ(bench.rate, *core::Rate::create(64'000'000, 42'667));
  EXPECT_EQ(unit.images_loaded(), 1);
  EXPECT_EQ(unit.forbidden_requests, 0);
}

TEST(Usb1608g, FourChannelsAt100HzOnAFullSpeedPort_EverySampleRight) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g(false);
  Bench bench(image.uri("&channels=0,1,2,3&range_v=10,5,2,2"), unit);
  bench.start(100, 2);

  const Reading reading = bench.read(2000, Usb1608gEmulator::kSkewS);

  EXPECT_EQ(reading.wrong, 0U);
  EXPECT_GE(reading.scans, 2000U);
}

TEST(Usb1608g, SecondHardwareRevision_TakesItsOwnImage) {
  const ImageFile image(73'722);
  Usb1608gEmulator unit(0x0135, "0123ABCD", moving_source());
  Bench bench("mcc:1608gx?fpga=" + image.path(), unit);
  bench.start(1500);

  EXPECT_TRUE(bench.reads_right(1500, Usb1608gEmulator::kSkewS));
}

TEST(Usb1608g, ImageOfTheWrongLength_RefusedBeforeItIsSent) {
  const ImageFile image(73'722);
  Usb1608gEmulator unit = unit_g();
  Bench bench(image.uri(), unit);

  const auto opened = bench.device->open();

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_NE(opened.error().what.find("73829"), std::string::npos);
  EXPECT_EQ(unit.images_loaded(), 0);
}

TEST(Usb1608g, NoImage_TheErrorSaysWhereToGetIt) {
  Usb1608gEmulator unit = unit_g();
  Bench bench("mcc:1608g", unit);

  const auto opened = bench.device->open();

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, core::ErrorCode::NotFound);
  EXPECT_NE(opened.error().hint.find("uldaq"), std::string::npos);
  EXPECT_NE(opened.error().hint.find("fpga=FILE"), std::string::npos);
}

TEST(Usb1608g, ImageStillThere_NotLoadedAgainAndNoFileNeeded) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  {
    Bench first(image.uri(), unit);
    first.start(1000);
    first.bus.unplug(unit);
  }
  core::VirtualClock clock{1'000'000'000'000'000};
  emulator::FakeBus bus(clock);
  bus.plug(unit);  // powers the unit up: the image is lost
  const physics::RigModel rig;
  auto device = create_device(image.uri(), {clock, rig, &bus});
  ASSERT_TRUE(device.has_value());
  ASSERT_TRUE((*device)->open());
  ASSERT_TRUE((*device)->close());
  EXPECT_EQ(unit.images_loaded(), 2);

  auto without_file = create_device("mcc:1608g", {clock, rig, &bus});

  EXPECT_TRUE((*without_file)->open());
  EXPECT_EQ(unit.images_loaded(), 2);
}

TEST(Usb1608g, SuspendDuringTheScan_BrokenThenTheImageIsLoadedAgain) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  Bench bench(image.uri(), unit);
  bench.start(1500);
  ASSERT_TRUE(bench.reads_right(1500, Usb1608gEmulator::kSkewS));

  unit.suspend(bench.clock.now_ns());
  const Reading reading = bench.read(3000, Usb1608gEmulator::kSkewS);
  EXPECT_EQ(reading.last.outcome, ReadOutcome::Broken);
  ASSERT_TRUE(bench.device->stop());
  bench.begin_segment();
  bench.start(1500);

  EXPECT_TRUE(bench.reads_right(1500, Usb1608gEmulator::kSkewS));
  EXPECT_EQ(unit.images_loaded(), 2);
}

TEST(Usb1608g, PowerCycle_TheImageIsLoadedAgain) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  Bench bench(image.uri(), unit);
  bench.start(1500);
  bench.bus.unplug(unit);
  EXPECT_EQ(bench.read(3000).last.outcome, ReadOutcome::Gone);
  ASSERT_TRUE(bench.device->close());
  bench.bus.plug(unit);
  bench.begin_segment();

  bench.start(1500);

  EXPECT_TRUE(bench.reads_right(1500, Usb1608gEmulator::kSkewS));
  EXPECT_EQ(unit.images_loaded(), 2);
}

TEST(Usb1608g, FirstSampleMissingAtTheStart_BrokenBeforeAnyScanThenRight) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  unit.rotated_starts = 1;
  Bench bench(image.uri(), unit);
  bench.start(1500);

  const Reading rotated = bench.read(3000, Usb1608gEmulator::kSkewS);
  ASSERT_TRUE(bench.device->stop());
  bench.start(1500);
  const Reading right = bench.read(3000, Usb1608gEmulator::kSkewS);

  EXPECT_EQ(rotated.scans, 0U);
  EXPECT_EQ(rotated.last.gap.reason, GapReason::Integrity);
  EXPECT_EQ(right.wrong, 0U);
  EXPECT_GE(right.scans, 3000U);
}

TEST(Usb1608g, FirmwareThatWants15Bytes_GetsThem) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  unit.takes_only_15_bytes = true;
  Bench bench(image.uri(), unit);
  bench.start(1500);

  EXPECT_EQ(unit.last_start().size(), 15U);
  EXPECT_TRUE(bench.reads_right(1500, Usb1608gEmulator::kSkewS));
}

TEST(Usb1608g, BurstInEitherReadingOfThePeriod_SameRate) {
  const ImageFile image;
  for (const bool divides : {false, true}) {
    Usb1608gEmulator unit = unit_g();
    unit.non_burst_divides_rate = divides;
    Bench bench(image.uri(), unit);
    bench.start(1500);

    const Reading reading = bench.read(6000, Usb1608gEmulator::kSkewS);

    EXPECT_EQ(reading.last.outcome, ReadOutcome::Scans);
    EXPECT_EQ(reading.wrong, 0U);
  }
}

TEST(Usb1608g, Trigger_ArmedUntilItFires) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  Bench bench(image.uri("&trigger=falling"), unit);
  bench.start(1500);
  core::Block block(16, 64);

  const ReadResult waiting = bench.device->read(block, bench.clock.now_ns() + 2 * kSecond);
  unit.fire_trigger(bench.clock.now_ns());

  EXPECT_EQ(waiting.outcome, ReadOutcome::Armed);
  EXPECT_EQ(unit.trigger_config(), 1);
  EXPECT_TRUE(bench.reads_right(1500, Usb1608gEmulator::kSkewS));
}

TEST(Usb1608g, HostAwayForLongerThanTheFifo_Overrun) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  Bench bench(image.uri(), unit);
  bench.start(1500);
  ASSERT_TRUE(bench.reads_right(1500, Usb1608gEmulator::kSkewS));

  bench.clock.advance_ns(200 * kMillisecond);  // the FIFO holds 170 ms

  EXPECT_EQ(bench.read(3000, Usb1608gEmulator::kSkewS).last.gap.reason, GapReason::Overrun);
}

TEST(Usb1608g, CalibrationCutShort_DataDamaged) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  unit.faults.calibration_bytes = 20;
  Bench bench(image.uri(), unit);

  const auto opened = bench.device->open();

  ASSERT_FALSE(opened.has_value());
  EXPECT_EQ(opened.error().code, core::ErrorCode::DataDamaged);
}

TEST(Usb1608g, ScanListNotTaken_StartRefused) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  unit.ignores_scan_list = true;
  Bench bench(image.uri(), unit);
  ASSERT_TRUE(bench.device->open());

  const auto started = bench.device->start({*core::Rate::from_hz(1500), 64});

  ASSERT_FALSE(started.has_value());
  EXPECT_EQ(started.error().code, core::ErrorCode::DataDamaged);
}

TEST(Usb1608g, ScanLeftRunningByAnotherProgram_EndsAndLeavesNothingBehind) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  Bench bench(image.uri("&channels=2,9,4,11,0"), unit);
  ASSERT_TRUE(bench.device->open());
  const Bytes start = encode_g_start({.period = 63'999, .packet_codes = 256, .has_trigger = false});
  ASSERT_EQ(unit.control({.request_type = 0x40, .request = 0x12, .length = 14}, start, bench.clock.now_ns()).kind,
            emulator::ReplyKind::Done);
  bench.clock.advance_ns(7 * kMillisecond);

  bench.start(1500);

  EXPECT_TRUE(bench.reads_right(3000, Usb1608gEmulator::kSkewS));
}

TEST(Usb1608g, FirstConversionAfterLoading_ThrownAway) {
  const ImageFile image;
  Usb1608gEmulator unit(0x0110, "0123ABCD", [](double, std::span<double> volts) {
    for (std::size_t i = 0; i < volts.size(); ++i) volts[i] = test::true_volts(i, 0.0);
  });
  Bench bench(image.uri(), unit);
  bench.start(1500);
  ASSERT_GE(bench.read(6000).scans, 6000U);  // what needs time to be judged is judged

  const DeviceReport report = bench.device->report();

  EXPECT_FALSE(report.checks.empty());
  for (const DeviceCheck& check : report.checks)
    EXPECT_EQ(check.outcome, DeviceCheck::Outcome::Passed) << check.name << ": " << check.detail;
}

TEST(Usb1608g, SingleReadingsLeftInTheFifo_GoneBeforeTheScan) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  unit.leaves_readings_in_fifo = true;
  Bench bench(image.uri("&channels=2,9,4,11,0"), unit);
  bench.start(1500);

  const Reading reading = bench.read(3000, Usb1608gEmulator::kSkewS);

  EXPECT_EQ(reading.wrong, 0U);
  EXPECT_GE(reading.scans, 3000U);
}

TEST(Usb1608g, FaultAfterTheTrigger_GoesOnWithoutIt) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  Bench bench(image.uri("&trigger=falling"), unit);
  bench.start(1500);
  ASSERT_TRUE(unit.is_armed());
  unit.fire_trigger(bench.clock.now_ns());
  unit.faults.overrun_at_code = 20'000;
  ASSERT_EQ(bench.read(6000, Usb1608gEmulator::kSkewS).last.gap.reason, GapReason::Overrun);
  ASSERT_TRUE(bench.device->stop());
  bench.begin_segment();

  bench.start(1500);

  EXPECT_FALSE(unit.is_armed());
  EXPECT_TRUE(bench.reads_right(1500, Usb1608gEmulator::kSkewS));
}

TEST(Usb1608g, ImageFileThatCannotBeOne_RefusedWithoutADevice) {
  core::VirtualClock clock;
  emulator::FakeBus bus(clock);
  const physics::RigModel rig;
  const ImageFile wrong(100);

  const auto missing = create_device("mcc:1608g?fpga=/nowhere/image.rbf", {clock, rig, &bus});
  const auto odd = create_device(wrong.uri(), {clock, rig, &bus});

  ASSERT_FALSE(missing.has_value());
  EXPECT_EQ(missing.error().code, core::ErrorCode::NotFound);
  EXPECT_NE(missing.error().what.find("/nowhere/image.rbf"), std::string::npos);
  ASSERT_FALSE(odd.has_value());
  EXPECT_EQ(odd.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_NE(odd.error().what.find("100 bytes"), std::string::npos) << odd.error().what;
}

TEST(Usb1608g, ImageFileByAPathThatDependsOnTheFolder_Refused) {
  core::VirtualClock clock;
  emulator::FakeBus bus(clock);
  const physics::RigModel rig;
  const ImageFile image;
  const std::string relative = std::filesystem::relative(image.path()).string();

  const auto refused = create_device("mcc:1608g?fpga=" + relative, {clock, rig, &bus});

  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_NE(refused.error().what.find("not a whole path"), std::string::npos) << refused.error().what;
}

TEST(Usb1608g, MuteDevice_Timeout) {
  Usb1608gEmulator unit = unit_g();
  unit.faults.is_mute = true;
  Bench bench("mcc:1608g", unit);

  EXPECT_EQ(bench.device->open().error().code, core::ErrorCode::Timeout);
}

}  // namespace
}  // namespace dts::device::mcc
