// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/clock.h"
#include "device/registry.h"
#include "physics/rig_model.h"

namespace dts::device::test {

inline constexpr std::int64_t kNoDeadline = std::numeric_limits<std::int64_t>::max();

/// The thesis's steel floor platform: corner supports 10.75 mm in, sensors 86 mm from the edges.
inline physics::RigModel floor_rig() {
  physics::RigModel rig;
  rig.support.inset = core::Millimetres{10.75};
  const auto add = [&rig](const char* label, double x_mm, double y_mm) {
    rig.sensors.push_back(
        {.label = label, .position = {core::Millimetres{x_mm}, core::Millimetres{y_mm}}, .curve = physics::SensorCurve::hoa1405_assumed()});
  };
  add("w1", 86.0, 86.0);
  add("w2", 344.0, 86.0);
  add("w3", 86.0, 344.0);
  add("w4", 344.0, 344.0);
  return rig;
}

/// The same rig with a Kistler plate of the size 9281EA: either part of `sim:stack`, which takes what it needs.
inline physics::RigModel stack_rig() {
  physics::RigModel rig = floor_rig();
  physics::KistlerPlate kistler{.a_mm = 120.0, .b_mm = 200.0, .az0_mm = -48.0};
  kistler.newtons_per_unit = {26.2, 26.5, 26.3, 26.3, 256.5, 257.1, 257.4, 257.0};
  auto plate = physics::ForcePlate::create(kistler);
  rig.force_plate = physics::ForcePlateModel{.plate = *plate,
                                             .channel_names = {"fx12", "fx34", "fy14", "fy23", "fz1", "fz2", "fz3", "fz4"},
                                             .tare_v = {0.01, -0.02, 0.0, 0.0, 0.03, 0.0, 0.0, -0.01}};
  return rig;
}

/// A file name that no other test program, build or case uses at the same time.
inline std::string temporary_path(const std::string& suffix) {
  const testing::TestInfo* test = testing::UnitTest::GetInstance()->current_test_info();
  return testing::TempDir() + "dts_" + std::to_string(getpid()) + "_" + test->name() + "_" + suffix;
}

inline core::Rate rate_of(double hz) { return *core::Rate::from_hz(hz); }

/// What came out of a device up to a number of scans.
struct Recorded {
  std::vector<std::vector<double>> channels;  ///< Per channel, all scans in a row.
  std::vector<std::int64_t> block_times_ns;   ///< Host time of each block's first scan.
  std::vector<std::uint64_t> block_firsts;
  std::vector<core::Gap> gaps;
};

/// A device with a rig and a clock of its own that runs as fast as it computes.
struct Bench {
  explicit Bench(const std::string& device_uri) : uri(device_uri) {
    auto created = create_device(uri, {clock, rig});
    EXPECT_TRUE(created.has_value()) << (created ? "" : core::to_string(created.error()));
    if (created) device = std::move(*created);
  }

  void start(double rate_hz, std::size_t max_block_scans = 64) {
    const auto opened = device->open();
    ASSERT_TRUE(opened.has_value()) << core::to_string(opened.error());
    const auto started = device->start({rate_of(rate_hz), max_block_scans});
    ASSERT_TRUE(started.has_value()) << core::to_string(started.error());
  }

  [[nodiscard]] core::Block block(std::size_t capacity) const { return {device->describe().channels.size(), capacity}; }

  /// Reads until `scans` have come (what the last block has more is dropped); gaps are noted, anything else stops.
  Recorded read_scans(std::size_t scans, std::size_t block_scans = 64) {
    core::Block buffer = block(block_scans);
    Recorded result;
    result.channels.resize(device->describe().channels.size());
    while (result.channels[0].size() < scans) {
      const ReadResult read = device->read(buffer, kNoDeadline);
      if (read.outcome == ReadOutcome::Gap) {
        result.gaps.push_back(read.gap);
        continue;
      }
      if (read.outcome != ReadOutcome::Scans) break;
      result.block_times_ns.push_back(buffer.host_time_ns);
      result.block_firsts.push_back(buffer.first_scan.value);
      for (std::size_t channel = 0; channel < result.channels.size(); ++channel) {
        const auto column = buffer.column(channel);
        result.channels[channel].insert(result.channels[channel].end(), column.begin(), column.end());
      }
    }
    for (std::vector<double>& channel : result.channels) channel.resize(std::min(channel.size(), scans));
    return result;
  }

  std::string uri;
  core::VirtualClock clock{1'000'000'000'000};
  physics::RigModel rig = floor_rig();
  std::unique_ptr<Device> device;
};

}  // namespace dts::device::test
