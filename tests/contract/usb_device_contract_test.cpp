// SPDX-License-Identifier: Apache-2.0
// What every device on USB promises besides: what its cable and its endpoint may do to a stream.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <vector>

#include "contract/device_contract.h"

namespace dts::device::contract {
namespace {

class UsbDeviceContract : public DeviceContract {};

/// Products whose drivers keep the whole device contract in the form of a sister product.
const std::array kSisters = {
    DeviceUnderTest{"mcc_1408fs_plus", "mcc:1408fs-plus?serial=01A2B3C4", "", "", fs_plus<emulator::FsPlusKind::Usb1408>},
    DeviceUnderTest{"mcc_usb_201", "mcc:usb-201?serial=01A2B3C4&channels=1,2,5", "", "", fs_plus<emulator::FsPlusKind::Usb201>},
    DeviceUnderTest{"mcc_usb_202", "mcc:usb-202?serial=01A2B3C4", "", "", fs_plus<emulator::FsPlusKind::Usb202>},
    DeviceUnderTest{"mcc_usb_204", "mcc:usb-204?serial=01A2B3C4", "", "", fs_plus<emulator::FsPlusKind::Usb204>},
    DeviceUnderTest{"mcc_1608gx", fpga_image("mcc:1608gx"), "", "", usb_1608g<0x0111>},
    DeviceUnderTest{"mcc_1608gx_2ao", fpga_image("mcc:1608gx-2ao"), "", "", usb_1608g<0x0112>},
};

std::vector<DeviceUnderTest> usb_devices() {
  std::vector<DeviceUnderTest> found;
  std::ranges::copy_if(kDevices, std::back_inserter(found), [](const DeviceUnderTest& tested) { return !tested.make_units().empty(); });
  found.insert(found.end(), kSisters.begin(), kSisters.end());
  return found;
}

/// Reads until something else than scans or nothing comes, or until `until_ns`.
ReadResult read_until_trouble(Device& device, core::Block& block, const core::Clock& clock, std::int64_t until_ns) {
  ReadResult read;
  do {
    read = device.read(block, clock.now_ns() + 100 * kMillisecond);
  } while ((read.outcome == ReadOutcome::Scans || read.outcome == ReadOutcome::Timeout) && clock.now_ns() < until_ns);
  return read;
}

TEST(UsbDevices, EveryOneThatTheProgramKnows_IsUnderThisContract) {
  RecordProperty("requirement", "ACQ-3");
  const std::vector<DeviceUnderTest> tested = usb_devices();
  for (const RegistryEntry& entry : registry()) {
    const bool is_on_usb = !entry.usb_models.empty() || entry.scheme_and_name.find("pair") != std::string::npos;
    const bool is_tested = std::ranges::any_of(tested, [&](const DeviceUnderTest& one) {
      const std::string uri = one.uri;
      return uri.substr(0, uri.find('?')) == entry.scheme_and_name;
    });
    EXPECT_EQ(is_tested, is_on_usb) << entry.scheme_and_name;
  }
}

TEST_P(UsbDeviceContract, EarlyLoss_ToldWithinThreeSeconds) {
  for (const auto& losing : units_) {  // each unit of a pair in turn
    for (const double rate_hz : {100.0, 1500.0}) {
      const auto device = create(GetParam().uri);
      const StartOptions options{test::rate_of(std::min(rate_hz, device->describe().maximum_rate_hz)), 64};
      const std::size_t channels = device->describe().channels.size() / units_.size();
      ASSERT_TRUE(device->open().has_value());
      core::Block block = block_for(*device, 64);
      for (const double hole_at_s : {0.05, 0.2, 0.9, 4.0}) {     // every one in a segment of its own, after a restart
        losing->faults.drop_packets = rate_hz > 1000.0 ? 2 : 1;  // 5 ms or more; one scan at 100 Hz
        losing->faults.drop_packet_at_code = static_cast<std::uint64_t>(hole_at_s * options.rate.hz()) * channels;
        ASSERT_TRUE(device->start(options).has_value());
        const std::int64_t start_ns = clock_.now_ns();

        const ReadResult read = read_until_trouble(*device, block, clock_, start_ns + 10 * kSecond);

        const double told_s = static_cast<double>(clock_.now_ns() - start_ns) * 1e-9;
        EXPECT_TRUE(read.outcome == ReadOutcome::Broken || read.outcome == ReadOutcome::Gap) << rate_hz << " Hz, " << hole_at_s << " s";
        EXPECT_EQ(read.gap.reason, core::GapReason::Integrity);
        EXPECT_LE(told_s, hole_at_s + 3.0 + 0.1) << rate_hz << " Hz";  // and the time from the start to the first scan
        ASSERT_TRUE(device->stop().has_value());
      }
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
  for (const auto& stalling : units_) {
    load_v = 0.0;
    stalling->faults.stall_at_code = 200 * channels / units_.size();
    ASSERT_TRUE(device->start(usual(*device)).has_value());
    const ReadResult broken = read_until_trouble(*device, block, clock_, clock_.now_ns() + 10 * kSecond);
    ASSERT_EQ(broken.outcome, ReadOutcome::Broken);
    EXPECT_EQ(broken.gap.reason, core::GapReason::Stall);
    bus_.run_until(clock_.now_ns() + 100 * kMillisecond);  // scans wait behind the halt
    ASSERT_TRUE(device->stop().has_value());

    load_v = 1.0;
    ASSERT_TRUE(device->start(usual(*device)).has_value());

    for (std::size_t scans = 0; scans < 100; scans += block.count()) {
      const ReadResult read = device->read(block, test::kNoDeadline);
      ASSERT_EQ(read.outcome, ReadOutcome::Scans);
      for (std::size_t channel = 0; channel < channels; ++channel) {
        if (device->describe().channels[channel].role == ChannelRole::Marker) continue;
        for (const double volts : block.column(channel)) ASSERT_GT(volts, 1.0) << "channel " << channel << " of the first " << scans + 64;
      }
    }
    ASSERT_TRUE(device->stop().has_value());
  }
}

/// A scan rate, and a pause that every device's buffer holds at it.
struct Pause {
  double rate_hz;
  std::int64_t pause_ns;
};

TEST_P(UsbDeviceContract, PauseThatTheDevicesBufferHolds_LosesNothing) {
  for (const auto& [rate_hz, pause_ns] : {Pause{100.0, 450 * kMillisecond}, Pause{1500.0, 150 * kMillisecond}}) {
    const auto device = create(GetParam().uri);
    ASSERT_TRUE(device->open().has_value());
    const std::size_t channels = device->describe().channels.size() / units_.size();
    for (const auto& unit : units_) {
      unit->faults.pause_at_code = static_cast<std::uint64_t>(rate_hz) * channels;
      unit->faults.pause_ns = pause_ns;
    }
    ASSERT_TRUE(device->start({test::rate_of(rate_hz), 64}).has_value());
    core::Block block = block_for(*device, 64);

    for (std::uint64_t next = 0; next < static_cast<std::uint64_t>(5.0 * rate_hz); next += block.count()) {
      const ReadResult read = device->read(block, clock_.now_ns() + 10 * kSecond);
      ASSERT_EQ(read.outcome, ReadOutcome::Scans) << rate_hz << " Hz, after " << next << " scans: " << name(read.gap.reason);
      ASSERT_EQ(block.first_scan.value, next);
    }
    ASSERT_TRUE(device->close().has_value());
  }
}

INSTANTIATE_TEST_SUITE_P(Devices, UsbDeviceContract, testing::ValuesIn(usb_devices()),
                         [](const testing::TestParamInfo<DeviceUnderTest>& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace dts::device::contract
