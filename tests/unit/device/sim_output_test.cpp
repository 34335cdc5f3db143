// SPDX-License-Identifier: Apache-2.0
// Every value that the simulated devices give, in sums: sim_outputs/ has an address, a rate and how many scans, and what came of it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "sim/chair_rig.h"
#include "support/committed_text.h"
#include "unit/device/sim_rig.h"

namespace dts::device {
namespace {

class SimOutput : public testing::TestWithParam<const char*> {};

/// Of one channel: first, last and a sum in which every scan has a weight of its own.
struct ChannelSums {
  double first = std::nan("");
  double last = std::nan("");
  double weighted = 0.0;
  double missing = 0.0;
  double bits = 0.0;

  void add(double value, std::uint8_t quality, std::uint64_t scan) {
    const double weight = 1.0 + static_cast<double>(scan * 7919 % 1009) / 1009.0;
    if (scan == 0) first = value;
    last = value;
    bits += weight * quality;
    (std::isnan(value) ? missing : weighted) += std::isnan(value) ? weight : weight * value;
  }
};

/// Reads so many scans. A cue comes at the 600th.
std::string output_of(Device& device, core::VirtualClock& clock, double rate_hz, std::uint64_t scans) {
  core::Block block(device.describe().channels.size(), 64);
  std::vector<ChannelSums> sums(block.channel_count());
  std::ostringstream text;
  text.precision(12);
  EXPECT_TRUE(device.open().has_value());
  EXPECT_TRUE(device.start({test::rate_of(rate_hz), 64}).has_value());
  const std::int64_t start_ns = clock.now_ns();
  bool is_cued = false;
  for (std::uint64_t scan = 0; scan < scans;) {
    if (scan >= 600 && !std::exchange(is_cued, true))
      device.hear({.is_go = true, .at_ns = clock.now_ns() + 50'000'000, .target_cm = 120.0});
    const ReadResult read = device.read(block, clock.now_ns() + 1'000'000'000);
    if (read.outcome != ReadOutcome::Scans) {
      text << "    at scan " << scan << ", " << clock.now_ns() - start_ns << " ns: outcome " << static_cast<int>(read.outcome) << ", "
           << name(read.gap.reason) << ", " << read.gap.missing_scans << (read.gap.is_exact ? " exactly" : " or so") << '\n';
      if (read.outcome == ReadOutcome::Gone) break;
    }
    for (std::size_t channel = 0; channel < sums.size(); ++channel) {
      for (std::size_t i = 0; i < block.count(); ++i) sums[channel].add(block.column(channel)[i], block.quality(channel)[i], scan + i);
    }
    scan += block.count();
  }
  text << "    until " << clock.now_ns() - start_ns << " ns, newest block of " << block.host_time_ns - start_ns << " ns, "
       << block.first_scan.value << '\n';
  for (std::size_t channel = 0; channel < sums.size(); ++channel) {
    const ChannelSums& of = sums[channel];
    text << "    " << device.describe().channels[channel].name << ' ' << of.first << ' ' << of.last << ' ' << of.weighted << " missing "
         << of.missing << " bits " << of.bits << '\n';
  }
  return text.str();
}

TEST_P(SimOutput, EachAddressOfTheFile_GivesItsValues) {
  const std::string file = std::string("unit/device/sim_outputs/") + GetParam() + ".txt";
  const std::string cop = std::string(testing::TempDir()) + "cop_" + GetParam() + std::to_string(getpid());
  const std::string weights = std::string(testing::TempDir()) + "weights_" + GetParam() + std::to_string(getpid());
  std::ofstream(cop) << "t_s,x_mm,y_mm\n0,-3,2\n0.5,1,-4\n1.25,6,0\n2,2,9\n";
  std::ofstream(weights) << "x_mm,y_mm,load_n\n-129,0,240\n64.5,-64.5,700\n0,43,1\n";
  std::string found;
  for (const std::string& line : dts::test::lines_of(dts::test::content_of(dts::test::committed_file(file)))) {
    if (line.starts_with(" ")) continue;
    SCOPED_TRACE(line);
    std::string uri;
    double rate_hz = 0.0;
    std::uint64_t scans = 0;
    std::istringstream(line) >> uri >> rate_hz >> scans;
    for (const auto& [word, path] : {std::pair{"=COP", cop}, {"=WEIGHTS", weights}}) {
      if (const std::size_t at = uri.find(word); at != std::string::npos) uri.replace(at + 1, std::string(word).size() - 1, path);
    }
    core::VirtualClock clock{1'000'000'000'000};
    const physics::RigModel rig = uri.starts_with("sim:chair")   ? dts::sim::chair_rig()
                                  : uri.starts_with("sim:stack") ? test::stack_rig()
                                                                 : test::floor_rig();
    const auto device = create_device(uri, {clock, rig});
    ASSERT_TRUE(device.has_value()) << core::to_string(device.error());
    found += line + "\n" + output_of(**device, clock, rate_hz, scans);
  }
  std::filesystem::remove(cop);
  std::filesystem::remove(weights);
  dts::test::expect_committed(file, found, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Files, SimOutput,
                         testing::Values("floor", "floor_fast", "floor_faults", "recording", "bench", "stack", "chair_1", "chair_2",
                                         "chair_3", "chair_4", "chair_5"),
                         [](const auto& file) { return std::string(file.param); });

}  // namespace
}  // namespace dts::device
