// SPDX-License-Identifier: Apache-2.0
// What every device on USB promises besides: what its cable and its endpoint may do to a stream.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <vector>

#include "contract/device_contract.h"

namespace dts::device::contract {
namespace {

class UsbDeviceContract : public DeviceContract {};

std::vector<DeviceUnderTest> usb_devices() {
  std::vector<DeviceUnderTest> found;
  std::ranges::copy_if(kDevices, std::back_inserter(found), [](const DeviceUnderTest& tested) { return !tested.make_units().empty(); });
  return found;
}

TEST_P(UsbDeviceContract, EarlyLoss_ToldWithinThreeSeconds) {
  for (const double rate_hz : {100.0, 1500.0}) {
    for (const double hole_at_s : {0.2, 0.9, 4.0}) {
      const auto device = create(GetParam().uri);
      const StartOptions options{test::rate_of(std::min(rate_hz, device->describe().maximum_rate_hz)), 64};
      const std::size_t channels = device->describe().channels.size() / units_.size();
      units_.back()->faults.drop_packets = rate_hz > 1000.0 ? 2 : 1;  // 5 ms or more; one scan at 100 Hz
      units_.back()->faults.drop_packet_at_code = static_cast<std::uint64_t>(hole_at_s * options.rate.hz()) * channels;
      ASSERT_TRUE(device->open().has_value());
      ASSERT_TRUE(device->start(options).has_value());
      core::Block block = block_for(*device, 64);
      const std::int64_t start_ns = clock_.now_ns();

      ReadResult read;
      do {
        read = device->read(block, clock_.now_ns() + 100 * kMillisecond);
      } while ((read.outcome == ReadOutcome::Scans || read.outcome == ReadOutcome::Timeout) && clock_.now_ns() < start_ns + 10 * kSecond);

      const double told_s = static_cast<double>(clock_.now_ns() - start_ns) * 1e-9;
      EXPECT_TRUE(read.outcome == ReadOutcome::Broken || read.outcome == ReadOutcome::Gap) << rate_hz << " Hz, " << hole_at_s << " s";
      EXPECT_EQ(read.gap.reason, core::GapReason::Integrity);
      EXPECT_LE(told_s, hole_at_s + 3.0 + 0.1) << rate_hz << " Hz";  // and the time from the start to the first scan
      ASSERT_TRUE(device->close().has_value());
    }
  }
}

TEST_P(UsbDeviceContract, ScansFromBeforeAStall_AreNotInTheNextSegment) {
  for (const auto& unit : units_) unit->faults.keeps_endpoint_buffer = true;
  const auto device = create(GetParam().uri);
  ASSERT_TRUE(device->open().has_value());
  const std::size_t channels = device->describe().channels.size();
  core::Block block = block_for(*device, 64);
  units_.back()->faults.stall_at_code = 200 * channels / units_.size();
  ASSERT_TRUE(device->start(usual(*device)).has_value());
  ReadResult read;
  while ((read = device->read(block, test::kNoDeadline)).outcome == ReadOutcome::Scans) {
  }
  ASSERT_EQ(read.outcome, ReadOutcome::Broken);
  EXPECT_EQ(read.gap.reason, core::GapReason::Stall);
  bus_.run_until(clock_.now_ns() + 100 * kMillisecond);  // scans wait behind the halt
  ASSERT_TRUE(device->stop().has_value());

  load_v = 1.0;
  ASSERT_TRUE(device->start(usual(*device)).has_value());

  std::size_t scans = 0;
  while (scans < 100) {
    read = device->read(block, test::kNoDeadline);
    ASSERT_EQ(read.outcome, ReadOutcome::Scans);
    for (std::size_t channel = 0; channel < channels; ++channel) {
      if (device->describe().channels[channel].role == ChannelRole::Marker) continue;
      for (const double volts : block.column(channel)) ASSERT_GT(volts, 1.0) << "channel " << channel << " of the first " << scans + 64;
    }
    scans += block.count();
  }
}

TEST_P(UsbDeviceContract, PauseThatTheDevicesBufferHolds_LosesNothing) {
  const auto device = create(GetParam().uri);
  ASSERT_TRUE(device->open().has_value());
  const std::size_t channels = device->describe().channels.size() / units_.size();
  for (const auto& unit : units_) {
    unit->faults.pause_at_code = 100 * channels;
    unit->faults.pause_ns = 450 * kMillisecond;
  }
  ASSERT_TRUE(device->start(usual(*device)).has_value());
  core::Block block = block_for(*device, 64);

  for (std::uint64_t next = 0; next < 500; next += block.count()) {
    const ReadResult read = device->read(block, clock_.now_ns() + 10 * kSecond);
    ASSERT_EQ(read.outcome, ReadOutcome::Scans) << "after " << next << " scans: " << name(read.gap.reason);
    ASSERT_EQ(block.first_scan.value, next);
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, UsbDeviceContract, testing::ValuesIn(usb_devices()),
                         [](const testing::TestParamInfo<DeviceUnderTest>& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace dts::device::contract
