// SPDX-License-Identifier: Apache-2.0
// USB-1608G, 1608GX and 1608GX-2AO: whole devices over an emulated unit and a virtual clock.
#include "device/mcc/usb1608g.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "device/mcc/fpga.h"
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

/// A unit on a bench with the image that it wants.
struct BenchG : Bench {
  BenchG(const ImageFile& image, Usb1608gEmulator& unit, const std::string& options = "") : Bench(image.uri(options), unit) {}
  bool reads_right(std::uint64_t scans) { return Bench::reads_right(scans, Usb1608gEmulator::kSkewS); }
};

TEST(Usb1608g, AnySpeedAndHardwareRevision_EverySampleRight) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  BenchG bench(image, unit, "&channels=15,3,8,0,1,2,4,5,6,7,12,11");
  bench.start(1500);
  EXPECT_TRUE(bench.reads_right(15'000));
  EXPECT_EQ(bench.rate, *core::Rate::create(64'000'000, 42'667));
  EXPECT_EQ(unit.images_loaded(), 1);
  EXPECT_EQ(unit.forbidden_requests, 0);

  Usb1608gEmulator full_speed = unit_g(false);
  BenchG slow(image, full_speed, "&channels=0,1,2,3&range_v=10,5,2,2");
  slow.start(100, 2);
  EXPECT_TRUE(slow.reads_right(2000));

  const ImageFile second_image(73'722);
  Usb1608gEmulator second_revision(0x0135, "0123ABCD", moving_source());
  Bench second("mcc:1608gx?fpga=" + second_image.path(), second_revision);
  second.start(1500);
  EXPECT_TRUE(second.reads_right(1500, Usb1608gEmulator::kSkewS));
}

TEST(Usb1608g, ImageStillThere_NotLoadedAgainAndNoFileNeeded) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  BenchG bench(image, unit);
  ASSERT_TRUE(bench.device->open());
  ASSERT_TRUE(bench.device->close());

  auto without_file = create_device("mcc:1608g", {bench.clock, bench.rig, &bench.bus});

  EXPECT_TRUE((*without_file)->open());
  EXPECT_EQ(unit.images_loaded(), 1);
}

TEST(Usb1608g, SuspendDuringTheScanOrPowerCycle_TheImageIsLoadedAgain) {
  for (const bool is_suspend : {true, false}) {
    const ImageFile image;
    Usb1608gEmulator unit = unit_g();
    BenchG bench(image, unit);
    bench.start(1500);
    ASSERT_TRUE(bench.reads_right(1500));

    if (is_suspend) unit.suspend(bench.clock.now_ns());
    if (!is_suspend) bench.bus.unplug(unit);
    EXPECT_EQ(bench.read(3000).last.outcome, is_suspend ? ReadOutcome::Broken : ReadOutcome::Gone);
    ASSERT_TRUE(is_suspend ? bench.device->stop() : bench.device->close());
    if (!is_suspend) bench.bus.plug(unit);
    bench.begin_segment();
    bench.start(1500);

    EXPECT_TRUE(bench.reads_right(1500));
    EXPECT_EQ(unit.images_loaded(), 2);
  }
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

TEST(Usb1608g, QuirksOfTheFirmware_EverySampleRight) {
  const ImageFile image;
  for (bool Usb1608gEmulator::*quirk :
       {&Usb1608gEmulator::takes_only_15_bytes, &Usb1608gEmulator::non_burst_divides_rate, &Usb1608gEmulator::leaves_readings_in_fifo}) {
    Usb1608gEmulator unit = unit_g();
    unit.*quirk = true;
    BenchG bench(image, unit, "&channels=2,9,4,11,0");
    bench.start(1500);

    EXPECT_EQ(unit.last_start().size(), unit.takes_only_15_bytes ? 15U : 14U);
    EXPECT_TRUE(bench.reads_right(6000));
  }
}

TEST(Usb1608g, Trigger_ArmedUntilItFiresAndAFaultGoesOnWithoutIt) {
  const ImageFile image;
  Usb1608gEmulator unit = unit_g();
  BenchG bench(image, unit, "&trigger=falling");
  bench.start(1500);
  core::Block block(16, 64);
  EXPECT_TRUE(unit.is_armed());
  EXPECT_EQ(bench.device->read(block, bench.clock.now_ns() + 2 * kSecond).outcome, ReadOutcome::Armed);
  EXPECT_EQ(unit.trigger_config(), 1);
  unit.fire_trigger(bench.clock.now_ns());
  EXPECT_TRUE(bench.reads_right(1500));
  unit.faults.overrun_at_code = 16 * 2500;
  ASSERT_EQ(bench.read(6000, Usb1608gEmulator::kSkewS).last.gap.reason, GapReason::Overrun);
  ASSERT_TRUE(bench.device->stop());
  bench.begin_segment();

  bench.start(1500);

  EXPECT_FALSE(unit.is_armed());
  EXPECT_TRUE(bench.reads_right(1500));
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

TEST(FpgaImage, LengthByTheHardwaresRevision_NothingElseIsTaken) {
  EXPECT_EQ(fpga_image_bytes(0x0133), 73'829U);
  EXPECT_EQ(fpga_image_bytes(0x0134), 73'722U);
  for (const std::size_t bytes : {0U, 73'721U, 73'722U, 73'723U, 73'828U, 73'829U, 73'830U}) {
    const ImageFile file(bytes);
    const core::Status checked = check_fpga_file(file.path());
    EXPECT_EQ(checked.has_value(), bytes == 73'722 || bytes == 73'829) << bytes;
    if (checked) continue;
    EXPECT_EQ(checked.error().what, "FPGA image " + file.path() + " has " + std::to_string(bytes) +
                                        " bytes; MCC's have 73829 or, for hardware revision 2, 73722");
    EXPECT_EQ(checked.error().code, core::ErrorCode::InvalidArgument);
  }
}

}  // namespace
}  // namespace dts::device::mcc
