// SPDX-License-Identifier: Apache-2.0
// The device over a stand-in for NI's library (tests/usb/nidaqmx_stub), with a virtual clock.
#include "device/nidaqmx/ni_daqmx.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "core/clock.h"
#include "device/registry.h"
#include "unit/device/nidaqmx/ni_rig.h"

namespace dts::device::nidaqmx {
namespace {

using core::ErrorCode;
using core::GapReason;
using emulator::NiStubControl;
using test::kMillisecond;
using test::kSecond;
using test::open_error;
using test::Rig;
using test::start_error;

std::unique_ptr<Device> create(const std::string& uri, core::Clock& clock) {
  const physics::RigModel plate = device::test::floor_rig();
  auto created = create_device(uri, {clock, plate});
  EXPECT_TRUE(created.has_value()) << (created ? "" : core::to_string(created.error()));
  return created ? std::move(*created) : nullptr;
}

TEST(NiDaqmx, WhatCannotBeOpened_SaysWhatToDoOrInNisWords) {
  core::VirtualClock clock;
  const core::Error no_library = open_error(*create("ni:Dev1?library=/nowhere/libnidaqmx.so.1", clock));
  EXPECT_EQ(no_library.code, ErrorCode::Unsupported);
  EXPECT_NE(no_library.what.find("NI-DAQmx is not installed"), std::string::npos) << no_library.what;
  EXPECT_NE(no_library.hint.find("install"), std::string::npos);
  const core::Error incomplete = open_error(*create(std::string("ni:Dev1?library=") + DTS_NIDAQMX_STUB_INCOMPLETE, clock));
  EXPECT_EQ(incomplete.code, ErrorCode::Unsupported);
  EXPECT_NE(incomplete.what.find("DAQmxReadAnalogF64"), std::string::npos) << incomplete.what;
  const core::Error wrong_name = open_error(*Rig("", "Dev7").device);
  EXPECT_EQ(wrong_name.code, ErrorCode::NotFound);
  EXPECT_NE(wrong_name.what.find("-200220"), std::string::npos) << wrong_name.what;
  EXPECT_NE(wrong_name.what.find("Device identifier is invalid. Device Specified: Dev7"), std::string::npos) << wrong_name.what;
  EXPECT_EQ(open_error(*Rig("channels=0,9").device).code, ErrorCode::Failed);
}

TEST(NiDaqmx, ReportsModelAndSerialNumberOfTheUnit) {
  RecordProperty("requirement", "COP-14");
  Rig rig;
  EXPECT_EQ(rig.device->describe().serial, "") << "Dev1 is a name that another unit can get";
  ASSERT_TRUE(rig.device->open());
  EXPECT_EQ(rig.device->report().model, "USB-6008");
  EXPECT_EQ(rig.device->report().serial, "01A2B3C4");
  Rig unnumbered;
  unnumbered.control.serial_number = 0;
  ASSERT_TRUE(unnumbered.device->open());
  EXPECT_EQ(unnumbered.device->report().serial, "");
}

TEST(NiDaqmx, Trigger_ArmedUntilItComesAndAFaultGoesOnWithoutIt) {
  Rig rig("channels=0&trigger=pfi1");
  rig.control.is_triggered = false;
  rig.start(1000);
  ASSERT_EQ(rig.control.trigger, "/Dev1/PFI1");
  for (int i = 0; i < 2; ++i) EXPECT_EQ(rig.read().outcome, ReadOutcome::Armed);
  rig.control.is_triggered = true;
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  rig.control.fail_status = -200279;
  rig.control.fail_at_read = rig.control.reads;
  ASSERT_EQ(rig.read().gap.reason, GapReason::Overrun);
  ASSERT_TRUE(rig.device->stop());
  rig.control.fail_at_read = NiStubControl::kNever;
  rig.control.is_triggered = false;

  rig.start(1000);

  EXPECT_EQ(rig.control.trigger, "");
  EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
}

TEST(NiDaqmx, TaskIsSetUp_AsTheUriSays) {
  Rig rig("channels=3,0&terminal=nrse&range_v=5&trigger=pfi0");
  rig.start(1000, 50);
  EXPECT_EQ(rig.control.channels, "Dev1/ai3, Dev1/ai0");
  EXPECT_EQ(rig.control.terminal, 10078);
  EXPECT_EQ(rig.control.minimum, -5.0);
  EXPECT_EQ(rig.control.maximum, 5.0);
  EXPECT_EQ(rig.control.rate_hz, 1000.0);
  EXPECT_EQ(rig.control.trigger, "/Dev1/PFI0");
  EXPECT_EQ(rig.control.buffer_scans, 4000U);
  EXPECT_EQ(rig.device->describe().channels[0].name, "ai3");
  EXPECT_EQ(rig.device->describe().channels[0].minimum, -5.0);
  EXPECT_EQ(rig.device->describe().channels[0].resolution, 0.0);
}

TEST(NiDaqmx, Streaming_EverySampleRight) {
  Rig rig("channels=0,1,2,3,4,5,6,7");
  rig.start(1500);
  for (std::uint64_t scan = 0; scan < 10 * 1500;) {
    ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
    ASSERT_EQ(rig.block.first_scan.value, scan);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rig.block.count(); ++i) {
      for (std::size_t channel = 0; channel < 8; ++channel) {
        wrong += rig.block.column(channel)[i] != emulator::ni_stub_volts(channel, scan + i) ? 1U : 0U;
        wrong += rig.block.quality(channel)[i] != 0 ? 1U : 0U;
      }
    }
    ASSERT_EQ(wrong, 0U) << scan;
    scan += rig.block.count();
  }
}

TEST(NiDaqmx, HostTime_IsThatOfTheScan) {
  Rig rig;
  rig.start(100, 10);
  const std::int64_t start_ns = rig.clock.now_ns();
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
    EXPECT_NEAR(static_cast<double>(rig.block.host_time_ns - start_ns), i * 100e6, 1e6) << i;
    EXPECT_GT(rig.block.host_time_uncertainty_ns, 0);
  }
}

TEST(NiDaqmx, WallClockSlewed_HostTimeFollows) {
  for (const std::int64_t step_ns : {kMillisecond, -kMillisecond}) {
    Rig rig;
    core::VirtualClock& clock = rig.clock;
    rig.control.now_ns = [&clock] { return clock.raw_ns(); };  // nobody slews the device
    rig.control.wait_until_ns = [&clock](std::int64_t time_ns) { clock.sleep_until_ns(clock.now_ns() + time_ns - clock.raw_ns()); };
    rig.start(100, 10);
    const std::int64_t start_raw_ns = clock.raw_ns();
    for (int i = 0; i < 600; ++i) {
      ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
      const std::int64_t truth_ns = core::monotonic_of_raw_ns(clock, start_raw_ns + i * 100 * kMillisecond);
      ASSERT_NEAR(static_cast<double>(rig.block.host_time_ns), static_cast<double>(truth_ns), 1e6) << i;
      if (i >= 100 && i < 400) clock.slew_ns(step_ns);
    }
    EXPECT_NEAR(rig.block.clock_drift_ppm, 0.0, 5.0);
  }
}

TEST(NiDaqmx, DeadlineFirst_DeliversWhatIsThere) {
  Rig rig;
  rig.start(100, 50);
  EXPECT_EQ(rig.read(25 * kMillisecond).outcome, ReadOutcome::Scans);
  EXPECT_EQ(rig.block.count(), 3U);  // at 0, 10 and 20 ms
  EXPECT_EQ(rig.read(4 * kMillisecond).outcome, ReadOutcome::Timeout);
  EXPECT_EQ(rig.block.count(), 0U);
}

TEST(NiDaqmx, ExactRate_WhatWasAskedForWithinLimits) {
  Rig rig;
  EXPECT_EQ(*rig.device->exact_rate(device::test::rate_of(1500)), device::test::rate_of(1500));
  EXPECT_EQ(rig.device->exact_rate(device::test::rate_of(0.5)).error().code, ErrorCode::InvalidArgument);
}

TEST(NiDaqmx, NotAMeasurement_NanWithAReason) {
  Rig rig("channels=0&range_v=4");
  rig.control.nan_at_scan = 5;
  rig.start(100, 10);
  ASSERT_EQ(rig.read().outcome, ReadOutcome::Scans);
  EXPECT_TRUE(std::isnan(rig.block.column(0)[5]));
  EXPECT_EQ(rig.block.quality(0)[5], core::quality::kOutOfRange);
  EXPECT_EQ(rig.block.column(0)[0], -4.0);
  EXPECT_EQ(rig.block.quality(0)[0], core::quality::kRail);
  EXPECT_EQ(rig.block.quality(0)[1], 0);
}

TEST(NiDaqmx, Error_ScansBeforeItThenBrokenUntilStopThenStartsAgain) {
  constexpr std::int32_t kTooMany = 0;  // no error, but a count that cannot be
  for (const auto& [status, reason] : {std::pair{-200279, GapReason::Overrun},
                                       {-200361, GapReason::Overrun},
                                       {-200222, GapReason::Overrun},
                                       {-50405, GapReason::Integrity},
                                       {kTooMany, GapReason::Integrity}}) {
    SCOPED_TRACE(status);
    Rig rig;
    rig.control.fail_at_read = status == kTooMany ? NiStubControl::kNever : 1;
    rig.control.fail_status = status;
    rig.control.gives_too_many = status == kTooMany;
    rig.start(100, 50);
    if (status != kTooMany) {
      EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
      EXPECT_EQ(rig.block.count(), 6U);  // those of the first 50 ms
    }
    for (int i = 0; i < 2; ++i) {
      const ReadResult result = rig.read();
      EXPECT_EQ(result.outcome, ReadOutcome::Broken);
      EXPECT_EQ(result.gap.reason, reason);
    }
    EXPECT_EQ(rig.device->state(), DeviceState::Streaming);
    const std::string detail = rig.device->report().checks.back().detail;
    EXPECT_TRUE(status == kTooMany || detail.find(std::to_string(status)) != std::string::npos) << detail;

    EXPECT_TRUE(rig.device->stop().has_value());
    rig.control.fail_at_read = NiStubControl::kNever;
    rig.control.gives_too_many = false;
    rig.start(1000);
    EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
    EXPECT_EQ(rig.block.first_scan.value, 0U);
  }
}

TEST(NiDaqmx, DeviceRemoved_GoneUntilClosed) {
  for (const std::int32_t status : {-200045, -201003}) {
    Rig rig;
    rig.control.fail_at_read = 2;
    rig.control.fail_status = status;
    rig.start(1000);
    ReadResult result = rig.read();
    while (result.outcome == ReadOutcome::Scans) result = rig.read();
    EXPECT_EQ(result.outcome, ReadOutcome::Gone) << status;
    EXPECT_EQ(result.gap.reason, GapReason::Unplugged);
    EXPECT_EQ(rig.device->state(), DeviceState::Gone);
    EXPECT_EQ(rig.device->open().error().code, ErrorCode::WrongState);
    EXPECT_EQ(rig.device->start({device::test::rate_of(100), 64}).error().code, ErrorCode::DeviceGone);
    EXPECT_EQ(rig.device->set_sync_output(true).error().code, ErrorCode::DeviceGone);
    EXPECT_TRUE(rig.device->stop().has_value());
    EXPECT_EQ(rig.read().outcome, ReadOutcome::Gone);
    EXPECT_TRUE(rig.device->close().has_value());
    EXPECT_EQ(rig.control.tasks, 0);
    rig.control.fail_at_read = NiStubControl::kNever;
    rig.start(1000);
    EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
  }
}

TEST(NiDaqmx, RemovedBeforeTheStart_Gone) {
  for (const bool is_known_by_name : {false, true}) {
    Rig rig;
    ASSERT_TRUE(rig.device->open().has_value());
    rig.control.is_present = !is_known_by_name;
    if (!is_known_by_name) rig.control.start_status = -200045;
    EXPECT_EQ(start_error(rig, 1000).code, ErrorCode::DeviceGone);
    EXPECT_EQ(rig.device->state(), DeviceState::Gone);
    EXPECT_TRUE(rig.device->close().has_value());
    if (is_known_by_name) {
      EXPECT_EQ(open_error(*rig.device).code, ErrorCode::NotFound);
    }
  }
}

TEST(NiDaqmx, StartRefused_OpenAndInNisWords) {
  Rig rig;
  rig.control.start_status = -200324;
  const core::Error error = start_error(rig, 1000);
  EXPECT_EQ(error.code, ErrorCode::Failed);
  EXPECT_NE(error.what.find("DAQmxStartTask: NI-DAQmx error -200324: Stub says no."), std::string::npos) << error.what;
  EXPECT_EQ(rig.device->state(), DeviceState::Open);
}

TEST(NiDaqmx, Interrupt_EndsAReadWithin100Ms) {
  Rig rig("trigger=pfi0");
  rig.control.is_triggered = false;
  rig.start(100, 10);
  const std::int64_t start_ns = rig.clock.now_ns();
  rig.control.wait_until_ns = [&rig, start_ns](std::int64_t time_ns) {
    if (time_ns > start_ns + kSecond) rig.device->interrupt();
    rig.clock.sleep_until_ns(time_ns);
  };
  EXPECT_EQ(rig.device->read(rig.block, device::test::kNoDeadline).outcome, ReadOutcome::Armed);
  EXPECT_LE(rig.clock.now_ns(), start_ns + kSecond + 100 * kMillisecond);
}

TEST(NiDaqmx, DestroyedWhileStreaming_TaskIsEnded) {
  Rig rig;
  rig.start(1000);
  EXPECT_EQ(rig.control.tasks, 1);
  EXPECT_EQ(rig.control.running, 1);
  rig.device.reset();
  EXPECT_EQ(rig.control.tasks, 0);
  EXPECT_EQ(rig.control.running, 0);
}

TEST(NiDaqmx, EveryOperationInEveryState) {
  Rig rig;
  Device& device = *rig.device;
  const StartOptions options{device::test::rate_of(100), 64};
  core::Block block(4, 64);
  EXPECT_EQ(device.start(options).error().code, ErrorCode::WrongState);
  EXPECT_EQ(device.read(block, 0).outcome, ReadOutcome::NotStreaming);
  EXPECT_EQ(device.set_sync_output(true).error().code, ErrorCode::WrongState);
  EXPECT_TRUE(device.stop().has_value());
  EXPECT_TRUE(device.close().has_value());
  EXPECT_TRUE(device.open().has_value());
  EXPECT_TRUE(device.open().has_value());
  EXPECT_EQ(device.read(block, 0).outcome, ReadOutcome::NotStreaming);
  EXPECT_EQ(device.set_sync_output(true).error().code, ErrorCode::Unsupported);
  EXPECT_TRUE(device.stop().has_value());
  EXPECT_TRUE(device.start(options).has_value());
  EXPECT_TRUE(device.open().has_value());
  EXPECT_EQ(device.start(options).error().code, ErrorCode::WrongState);
  core::Block too_narrow(3, 64);
  EXPECT_EQ(device.read(too_narrow, rig.clock.now_ns() + kSecond).outcome, ReadOutcome::Timeout);
  EXPECT_TRUE(device.stop().has_value());
  EXPECT_EQ(device.state(), DeviceState::Open);
  EXPECT_TRUE(device.start(options).has_value());
  EXPECT_TRUE(device.close().has_value());
  EXPECT_EQ(device.state(), DeviceState::Closed);
}

}  // namespace
}  // namespace dts::device::nidaqmx
