// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/clock.h"
#include "device/registry.h"
#include "physics/rig_model.h"
#include "usb/emulator/emulated_device.h"
#include "usb/fake/fake_bus.h"

namespace dts::device::mcc::test {

inline constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
inline constexpr std::int64_t kSecond = 1000 * kMillisecond;

/// Different at every input and every moment: a rotated channel or a scan too many shows.
inline double true_volts(std::size_t input, double time_s) {
  const auto number = static_cast<double>(input);
  return -1.3 + 0.2 * number + 0.1 * std::sin(2.0 * M_PI * (3.0 + 0.1 * number) * time_s + number);
}

/// `first`: number of input 0, for the second unit of a pair.
inline emulator::Source moving_source(std::size_t first = 0) {
  return [first](double time_s, std::span<double> volts) {
    for (std::size_t input = 0; input < volts.size(); ++input) volts[input] = true_volts(first + input, time_s);
  };
}

struct Reading {
  std::uint64_t scans = 0;
  std::uint64_t wrong = 0;  ///< Values that are not what stood at the input at the scan's instant.
  ReadResult last;          ///< How it ended.
};

/// A device over a bus with a virtual clock.
struct Bench {
  explicit Bench(const std::string& device_uri) : uri(device_uri) {
    auto created = create_device(uri, {clock, rig, &bus});
    EXPECT_TRUE(created.has_value()) << (created ? "" : core::to_string(created.error()));
    if (created) device = std::move(*created);
  }
  Bench(const std::string& device_uri, emulator::EmulatedDevice& unit) : Bench(device_uri) { bus.plug(unit); }

  void start(double rate_hz, std::size_t max_block_scans = 64) {
    const auto opened = device->open();
    ASSERT_TRUE(opened.has_value()) << core::to_string(opened.error());
    const auto started = device->start({*core::Rate::from_hz(rate_hz), max_block_scans});
    ASSERT_TRUE(started.has_value()) << core::to_string(started.error());
    rate = *started;
    block_scans = max_block_scans;
  }

  /// Reads until `scans` have come or something other than scans; compares every value with the truth. `skew_s` between the
  /// channels of a scan.
  Reading read(std::uint64_t scans, double skew_s = 0.0) {
    const std::vector<ChannelDescription>& channels = device->describe().channels;
    core::Block block(channels.size(), block_scans);
    Reading reading;
    while (reading.scans < scans) {
      reading.last = device->read(block, clock.now_ns() + 10 * kSecond);
      if (reading.last.outcome != ReadOutcome::Scans) break;
      EXPECT_EQ(block.first_scan.value, next_scan);
      for (std::size_t channel = 0; channel < channels.size(); ++channel) {
        const std::size_t input = std::stoul(channels[channel].name.substr(2));
        const std::span<const double> values = std::as_const(block).column(channel);
        for (std::size_t i = 0; i < values.size(); ++i) {
          const double time_s = static_cast<double>(next_scan + i) / rate.hz() + skew_s * static_cast<double>(channel);
          const double tolerance_v = 0.55 * channels[channel].resolution;
          if (!(std::abs(values[i] - true_volts(input, time_s)) <= tolerance_v)) ++reading.wrong;
        }
      }
      next_scan += block.count();
      reading.scans += block.count();
    }
    return reading;
  }

  /// That many came, and all were right.
  bool reads_right(std::uint64_t scans, double skew_s = 0.0) {
    const Reading reading = read(scans, skew_s);
    return reading.scans >= scans && reading.wrong == 0;
  }

  /// After `stop` and `start`.
  void begin_segment() { next_scan = 0; }

  std::string uri;
  core::VirtualClock clock{1'000'000'000'000};
  emulator::FakeBus bus{clock};
  physics::RigModel rig;
  std::unique_ptr<Device> device;
  core::Rate rate;
  std::size_t block_scans = 64;
  std::uint64_t next_scan = 0;
};

}  // namespace dts::device::mcc::test
