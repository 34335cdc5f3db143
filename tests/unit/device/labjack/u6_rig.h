// SPDX-License-Identifier: Apache-2.0
// An emulated U6 on a bus with a virtual clock, and the device that the registry makes of its URI.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/clock.h"
#include "device/registry.h"
#include "unit/device/sim_rig.h"
#include "usb/emulator/u6_emulator.h"
#include "usb/fake/fake_bus.h"

namespace dts::device::labjack::test_u6 {

using emulator::U6Emulator;

inline constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
inline constexpr std::int64_t kSecond = 1000 * kMillisecond;
inline constexpr double kSkewS = 20e-6;  // the emulator's, between two conversions of a scan
inline constexpr const char* kEleven = "labjack:u6?channels=0,1,2,3,4,5,6,7,8,9&marker=15&marker_v=0";

/// Every input at every instant has a voltage of its own: a ramp that takes 2 s, 0.4 V higher for each input.
inline double ramp_v(std::size_t input, double time_s) {
  return 0.4 * static_cast<double>(input) - 3.0 + 3.0 * (time_s / 2.0 - std::floor(time_s / 2.0));
}

inline void ramp(double time_s, std::span<double> volts) {
  for (std::size_t input = 0; input < volts.size(); ++input) volts[input] = ramp_v(input, time_s);
}

struct Rig {
  explicit Rig(const std::string& uri, U6Emulator::Identity identity = {}, emulator::Source source = ramp)
      : unit(std::move(source), identity) {
    bus.plug(unit);
    auto created = create_device(uri, {clock, plate, &bus});
    EXPECT_TRUE(created.has_value()) << (created ? "" : core::to_string(created.error()));
    if (created) device = std::move(*created);
  }

  void start(double rate_hz, std::size_t block_scans = 64) {
    const auto opened = device->open();
    ASSERT_TRUE(opened.has_value()) << core::to_string(opened.error());
    restart(rate_hz, block_scans);
  }

  void restart(double rate_hz, std::size_t block_scans = 64) {
    const auto started = device->start({test::rate_of(rate_hz), block_scans});
    ASSERT_TRUE(started.has_value()) << core::to_string(started.error());
    rate = *started;
    block = core::Block(device->describe().channels.size(), block_scans);
    segment_start = 0;
    inputs.clear();
    for (const ChannelDescription& channel : device->describe().channels) {
      inputs.push_back(channel.unit == "V" ? static_cast<std::size_t>(std::stoi(channel.name.substr(2))) : U6Emulator::kFio0);
    }
  }

  ReadResult read() { return device->read(block, clock.now_ns() + kSecond); }

  /// Values of the block in hand that are not what stood at the input. `step_v`: one code.
  std::size_t wrong_values(double step_v = U6Emulator::step_v(0)) {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < block.count(); ++i) {
      const auto scan = static_cast<double>(segment_start + block.first_scan.value + i);
      const double time_s = scan * static_cast<double>(rate.denominator()) / static_cast<double>(rate.numerator());
      for (std::size_t position = 0; position < inputs.size(); ++position) {
        const double truth_v =
            inputs[position] == U6Emulator::kGround ? 0.0 : ramp_v(inputs[position], time_s + static_cast<double>(position) * kSkewS);
        wrong += std::abs(block.column(position)[i] - truth_v) > 0.51 * step_v ? 1U : 0U;
        wrong += block.quality(position)[i] != 0 ? 1U : 0U;
      }
    }
    return wrong;
  }

  /// Reads and checks until `scans` have come or something else happens, which is returned.
  ReadResult read_and_check(std::uint64_t scans) {
    ReadResult result{ReadOutcome::Scans, {}};
    std::uint64_t expected = 0;
    for (taken = 0; taken < scans;) {
      result = read();
      if (result.outcome != ReadOutcome::Scans) return result;
      if (taken == 0) expected = block.first_scan.value;
      EXPECT_EQ(block.first_scan.value, expected);
      EXPECT_EQ(wrong_values(), 0U) << "from scan " << expected;
      expected += block.count();
      taken += block.count();
    }
    return result;
  }

  core::VirtualClock clock{1'000 * kSecond};
  physics::RigModel plate = test::floor_rig();
  U6Emulator unit;
  emulator::FakeBus bus{clock};
  std::unique_ptr<Device> device;
  core::Rate rate;
  core::Block block;
  std::vector<std::size_t> inputs;
  std::uint64_t segment_start = 0;  ///< Scan of the device at which the segment began.
  std::uint64_t taken = 0;
};

inline core::Error open_error(Rig& rig) {
  const auto opened = rig.device->open();
  EXPECT_FALSE(opened.has_value());
  EXPECT_EQ(rig.device->state(), DeviceState::Closed);
  EXPECT_EQ(rig.bus.open_ports(), 0);
  return opened ? core::Error{} : opened.error();
}

}  // namespace dts::device::labjack::test_u6
