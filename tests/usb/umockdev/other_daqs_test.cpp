// SPDX-License-Identifier: Apache-2.0
// The second vendor and the device with an FPGA image over unmodified libusb; what is common to all is in fs_plus_daq_test.cpp.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "usb/emulator/u6_emulator.h"
#include "usb/emulator/usb1608g_emulator.h"
#include "usb/umockdev/daq_fixture.h"

namespace dts::emulator {
namespace {

using core::GapReason;
using device::ReadOutcome;

constexpr const char* kEightInputs = "channels=0,1,2,3,4,5,6,7";
constexpr std::uint64_t kOtherChannels = 8;
constexpr double kRateHz = 500.0;
constexpr std::uint64_t kFaultScan = 300;

template <class Emulator>
class OtherDaqTest : public DaqFixture {
 protected:
  void TearDown() override {
    device_.reset();
    if (daq_) host_.unplug(*daq_);
  }
  void run(const std::string& uri, double rate_hz) {
    create(uri, rate_hz);
    host_.plug(*daq_);
    open();
    start();
  }
  void expect_whole(std::uint64_t scans) {
    EXPECT_EQ(listen(scans).wrong, 0U);
    EXPECT_GE(heard_.scans, scans);
    std::printf("  8 x %.5f Hz: %llu scans, %llu wrong samples\n", stairs_.rate_hz, static_cast<unsigned long long>(heard_.scans),
                static_cast<unsigned long long>(heard_.wrong));
  }
  void expect_gone_and_back() {
    host_.unplug(*daq_);
    static_cast<void>(listen(1'000'000));
    EXPECT_EQ(heard_.end.outcome, ReadOutcome::Gone);
    EXPECT_TRUE(device_->close());
    host_.plug(*daq_);
    ASSERT_TRUE(eventually([&] { return device_->open().has_value(); }));
    start();
    EXPECT_EQ(listen(300).wrong, 0U);
  }
  void expect_broken_and_recovered(const char* what, double scan, GapReason reason) {
    EXPECT_EQ(heard_.wrong, 0U);
    EXPECT_EQ(heard_.end.outcome, ReadOutcome::Broken);
    EXPECT_EQ(heard_.end.gap.reason, reason);
    expect_soon(what, scan, reason == GapReason::Silence ? kSilenceSoonMs : kSoonMs);
    EXPECT_TRUE(device_->stop());
    host_.locked(*daq_, [&] { daq_->faults = {}; });
    start();
    EXPECT_EQ(listen(600).wrong, 0U);
  }

  std::unique_ptr<Emulator> daq_;
};

class U6DaqTest : public OtherDaqTest<U6Emulator> {
 protected:
  U6DaqTest() { daq_ = std::make_unique<U6Emulator>(stairs_.source()); }
  const std::string uri_ = std::string("labjack:u6?") + kEightInputs;
};

TEST_F(U6DaqTest, StreamsWholeAndSurvivesThePlug) {
  run(uri_, kRateHz);
  expect_whole(1000);
  expect_gone_and_back();
}

TEST_F(U6DaqTest, ABadChecksumIsTold) {
  daq_->faults.corrupt_at_code = kFaultScan * kOtherChannels + 3;
  run(uri_, kRateHz);

  static_cast<void>(listen(1'000'000));

  expect_broken_and_recovered("a bad checksum", kFaultScan, GapReason::Integrity);
}

TEST_F(U6DaqTest, SilenceIsTold) {
  daq_->faults.silence_at_code = kFaultScan * kOtherChannels + 3;
  run(uri_, kRateHz);

  static_cast<void>(listen(1'000'000));

  expect_broken_and_recovered("silence", kFaultScan, GapReason::Silence);
}

class Usb1608gDaqTest : public OtherDaqTest<Usb1608gEmulator> {
 protected:
  static constexpr std::uint16_t kProduct = 0x0134;

  Usb1608gDaqTest() : image_("/tmp/dts-fpga-" + std::to_string(::getpid())) {
    daq_ = std::make_unique<Usb1608gEmulator>(kProduct, "01B2C3D4", stairs_.source());
    std::ofstream(image_) << std::string(Usb1608gEmulator::image_bytes(kProduct), 'x');
  }
  ~Usb1608gDaqTest() override { std::filesystem::remove(image_); }

  std::string image_;
  const std::string uri_ = std::string("mcc:1608g?") + kEightInputs + "&fpga=" + image_;
};

TEST_F(Usb1608gDaqTest, TakesItsImageAndStreamsWholeAndSurvivesThePlug) {
  run(uri_, kRateHz);
  host_.locked(*daq_, [&] { EXPECT_EQ(daq_->images_loaded(), 1); });
  expect_whole(1000);
  expect_gone_and_back();
  host_.locked(*daq_, [&] { EXPECT_EQ(daq_->images_loaded(), 2); });  // power was gone
}

TEST_F(Usb1608gDaqTest, AStallIsTold) {
  daq_->faults.stall_at_code = kFaultScan * kOtherChannels + 3;
  run(uri_, kRateHz);

  static_cast<void>(listen(1'000'000));

  expect_broken_and_recovered("a stall", kFaultScan, GapReason::Stall);
}

TEST_F(Usb1608gDaqTest, AnOverrunIsTold) {
  daq_->faults.overrun_at_code = kFaultScan * kOtherChannels + 3;
  run(uri_, kRateHz);

  static_cast<void>(listen(1'000'000));

  expect_broken_and_recovered("an overrun", kFaultScan, GapReason::Overrun);
}

}  // namespace
}  // namespace dts::emulator
