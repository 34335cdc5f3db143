// SPDX-License-Identifier: Apache-2.0
// A whole USB-1608FS-Plus over unmodified libusb: every sample checked, every fault told and recovered from.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>

#include "support/allocation_counter.h"
#include "usb/emulator/fs_plus_emulator.h"
#include "usb/umockdev/daq_fixture.h"

namespace dts::emulator {
namespace {

using core::ErrorCode;
using core::GapReason;
using device::ReadOutcome;

constexpr const char* kUri = "mcc:1608fs-plus?serial=01D4E5F6";
constexpr std::uint64_t kChannels = 8;

class FsPlusDaqTest : public DaqFixture {
 protected:
  void TearDown() override {
    device_.reset();
    host_.unplug(daq_);
  }
  void run(const std::string& uri = kUri, double rate_hz = 1500.0) {
    create(uri, rate_hz);
    host_.plug(daq_);
    open();
    start();
  }
  /// A fault in scan `scan`, at its channel 3.
  [[nodiscard]] static std::uint64_t code_in(std::uint64_t scan) { return scan * kChannels + 3; }

  /// Ends as `reason`, and works again after stop and start.
  void expect_broken_and_recovered(const char* what, double scan, GapReason reason) {
    EXPECT_EQ(heard_.wrong, 0U);
    EXPECT_EQ(heard_.end.outcome, ReadOutcome::Broken);
    EXPECT_EQ(heard_.end.gap.reason, reason);
    expect_soon(what, scan, reason == GapReason::Silence ? kSilenceSoonMs : kSoonMs);
    EXPECT_TRUE(device_->stop());
    host_.locked(daq_, [&] { daq_.faults = {}; });
    start();
    EXPECT_EQ(listen(600).wrong, 0U);
    EXPECT_GE(heard_.scans, 600U);
  }

  FsPlusEmulator daq_{FsPlusKind::Usb1608, "01D4E5F6", stairs_.source()};
};

TEST_F(FsPlusDaqTest, EightChannelsAt1500HzArriveWhole) {
  RecordProperty("requirement", "ACQ-1");
  run();

  const Heard& heard = listen(3000);

  EXPECT_EQ(heard.end.outcome, ReadOutcome::NotStreaming);  // nothing ended it
  EXPECT_EQ(heard.wrong, 0U);
  std::printf("  8 x %.5f Hz: %llu scans, %llu wrong samples\n", stairs_.rate_hz, static_cast<unsigned long long>(heard.scans),
              static_cast<unsigned long long>(heard.wrong));
  EXPECT_TRUE(device_->stop());
}

TEST_F(FsPlusDaqTest, FourChannelsAt100HzArriveWhole) {
  RecordProperty("requirement", "ACQ-1");
  run("mcc:1608fs-plus?channels=0,1,2,3", 100.0);

  const Heard& heard = listen(200);

  EXPECT_EQ(heard.end.outcome, ReadOutcome::NotStreaming);  // nothing ended it
  EXPECT_EQ(heard.wrong, 0U);
  std::printf("  4 x %.5f Hz: %llu scans, %llu wrong samples\n", stairs_.rate_hz, static_cast<unsigned long long>(heard.scans),
              static_cast<unsigned long long>(heard.wrong));
  EXPECT_TRUE(device_->stop());
}

TEST_F(FsPlusDaqTest, AnOverrunIsTold) {
  daq_.faults.overrun_at_code = code_in(900);
  run();

  static_cast<void>(listen(100'000));

  expect_broken_and_recovered("an overrun", 900, GapReason::Overrun);
}

TEST_F(FsPlusDaqTest, AStallIsTold) {
  daq_.faults.stall_at_code = code_in(900);
  run();

  static_cast<void>(listen(100'000));

  expect_broken_and_recovered("a stall", 900, GapReason::Stall);
}

TEST_F(FsPlusDaqTest, SilenceIsTold) {
  daq_.faults.silence_at_code = code_in(900);
  run();

  static_cast<void>(listen(100'000));

  expect_broken_and_recovered("silence", 900, GapReason::Silence);
}

TEST_F(FsPlusDaqTest, AShortPacketIsTold) {
  daq_.faults.short_packet_at_code = code_in(900);
  run();

  static_cast<void>(listen(100'000));

  expect_broken_and_recovered("a short packet", 900, GapReason::Integrity);
}

TEST_F(FsPlusDaqTest, BabbleIsTold) {
  daq_.faults.babble_at_code = code_in(900);
  run();

  static_cast<void>(listen(100'000));

  expect_broken_and_recovered("babble", 900, GapReason::Integrity);
}

TEST_F(FsPlusDaqTest, ARotationByOneSampleIsToldByTheMarkerBeforeAWrongScanIsDelivered) {
  RecordProperty("requirement", "ACQ-6");
  stairs_.marked = 7;
  daq_.faults.drop_code_at = code_in(900);
  run("mcc:1608fs-plus?marker=7&marker_v=4.5");

  static_cast<void>(listen(100'000));

  EXPECT_EQ(heard_.scans, 900U);  // everything before it, nothing after
  expect_broken_and_recovered("a rotation", 900, GapReason::Integrity);
}

TEST_F(FsPlusDaqTest, ACalibrationOfTheWrongLengthIsRefused) {
  daq_.faults.calibration_bytes = 100;
  create(kUri, 1500.0);
  host_.plug(daq_);

  const auto opened = device_->open();

  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::DataDamaged) << core::to_string(opened.error());
  host_.locked(daq_, [&] { daq_.faults = {}; });
  EXPECT_TRUE(device_->open());
}

TEST_F(FsPlusDaqTest, ARequestWithoutAnswerIsToldAndTheNextOpenWorks) {
  daq_.faults.silent_control_requests = 1;
  create(kUri, 1500.0);
  host_.plug(daq_);
  bus_.is_patient = false;

  const auto opened = device_->open();

  bus_.is_patient = true;
  ASSERT_FALSE(opened);
  EXPECT_EQ(opened.error().code, ErrorCode::Timeout) << core::to_string(opened.error());
  EXPECT_TRUE(device_->open());
}

TEST_F(FsPlusDaqTest, UnpluggingWhileStreamingIsToldAndTheSameUnitStreamsAgain) {
  RecordProperty("requirement", "ACQ-5");
  run();
  EXPECT_EQ(listen(600).wrong, 0U);
  const std::int64_t pulled_ns = clock_.now_ns();

  host_.unplug(daq_);
  static_cast<void>(listen(100'000));

  EXPECT_EQ(heard_.end.outcome, ReadOutcome::Gone);
  EXPECT_EQ(heard_.end.gap.reason, GapReason::Unplugged);
  const double ms = static_cast<double>(heard_.end_ns - pulled_ns) * 1e-6;
  std::printf("  detected unplugging after %.1f ms\n", ms);
  EXPECT_LT(ms, kSoonMs);
  EXPECT_TRUE(device_->close());
  EXPECT_EQ(device_->open().error().code, ErrorCode::NotFound);
  static_cast<void>(device_->has_arrived());
  host_.plug(daq_);
  EXPECT_TRUE(eventually([&] { return device_->has_arrived(); }));
  open();
  start();
  EXPECT_EQ(listen(600).wrong, 0U);
}

TEST_F(FsPlusDaqTest, TwentyReplugsWhileStreamingLeaveNothingBehind) {
  create(kUri, 1500.0);
  double worst_ms = 0.0;
  for (int cycle = 0; cycle < 20; ++cycle) {
    host_.plug(daq_);
    ASSERT_TRUE(eventually([&] { return device_->open().has_value(); })) << "cycle " << cycle;
    start();
    ASSERT_EQ(listen(150).wrong, 0U) << "cycle " << cycle;
    const std::int64_t pulled_ns = clock_.now_ns();
    host_.unplug(daq_);
    static_cast<void>(listen(100'000));
    ASSERT_EQ(heard_.end.outcome, ReadOutcome::Gone) << "cycle " << cycle;
    worst_ms = std::max(worst_ms, static_cast<double>(heard_.end_ns - pulled_ns) * 1e-6);
    ASSERT_TRUE(device_->close());
  }
  std::printf("  20 replug cycles, departure told after at most %.1f ms\n", worst_ms);
  EXPECT_LT(worst_ms, kSoonMs);
}

TEST_F(FsPlusDaqTest, ASuspendedMachineEndsTheStreamAndTheUnitIsOpenedAgain) {
  run();
  EXPECT_EQ(listen(300).wrong, 0U);

  host_.suspend(daq_);
  static_cast<void>(listen(100'000));

  EXPECT_EQ(heard_.end.outcome, ReadOutcome::Gone);
  EXPECT_TRUE(device_->close());
  ASSERT_TRUE(eventually([&] { return device_->open().has_value(); }));
  start();
  EXPECT_EQ(listen(300).wrong, 0U);
}

TEST_F(FsPlusDaqTest, StopReturnsWithin250MsOfAnIdleMachineAndNothingIsInFlight) {
  run();
  EXPECT_EQ(listen(300).wrong, 0U);
  const std::int64_t before_ns = clock_.now_ns();

  EXPECT_TRUE(device_->stop());

  EXPECT_LE(clock_.now_ns() - before_ns, 250 * core::kNanosecondsPerMillisecond);
  EXPECT_EQ(host_.urbs_in_flight(daq_), 0U);
}

TEST_F(FsPlusDaqTest, AUnitOfAnotherProgramIsRefusedUntilItIsFree) {
  create(kUri, 1500.0);
  host_.plug(daq_);
  host_.occupy(daq_, true);

  EXPECT_EQ(device_->open().error().code, ErrorCode::WrongState);
  host_.occupy(daq_, false);

  EXPECT_TRUE(device_->open());
}

TEST_F(FsPlusDaqTest, AnInterruptFromAnotherThreadEndsTheRead) {
  run(std::string(kUri) + "&trigger=rising");  // nothing comes, and that is no fault: only the interrupt ends the read
  std::atomic<bool> has_returned{false};

  std::jthread reader([&] {
    core::Block block(kChannels, 64);
    EXPECT_EQ(device_->read(block, clock_.now_ns() + 3600'000 * core::kNanosecondsPerMillisecond).outcome, ReadOutcome::Armed);
    has_returned.store(true, std::memory_order_release);
  });
  while (!has_returned.load(std::memory_order_acquire)) {
    device_->interrupt();
    std::this_thread::yield();
  }
  reader.join();

  EXPECT_TRUE(device_->stop());
}

TEST_F(FsPlusDaqTest, TheReadingThreadAllocatesNothingWhileScansFlow) {
  run();
  ASSERT_EQ(listen(300).wrong, 0U);

  const std::uint64_t before = test::heap_calls_of_this_thread();
  ASSERT_EQ(listen(1500).wrong, 0U);

  EXPECT_EQ(test::heap_calls_of_this_thread(), before);
}

TEST_F(FsPlusDaqTest, TwoUnitsStreamSideBySide) {
  FsPlusEmulator other_daq(FsPlusKind::Usb1608, "02AAAAAA", stairs_.source());
  host_.plug(other_daq);
  run();
  auto other = device::create_device("mcc:1608fs-plus?serial=02AAAAAA", {clock_, rig_, &bus_}).value();
  ASSERT_TRUE(other->open());
  ASSERT_TRUE(other->start({wanted_, 64}));
  core::Block block(kChannels, 64);
  std::uint64_t others = 0;

  for (std::uint64_t target = 150; target <= 900; target += 150) {
    EXPECT_EQ(listen(target).wrong, 0U);
    while (others < target) {
      ASSERT_EQ(other->read(block, clock_.now_ns() + 2000 * core::kNanosecondsPerMillisecond).outcome, ReadOutcome::Scans);
      others += block.count();
    }
  }

  EXPECT_TRUE(other->close());
  other.reset();
  host_.unplug(other_daq);
}

}  // namespace
}  // namespace dts::emulator
