// SPDX-License-Identifier: Apache-2.0
#include "device/labjack/u6_timing.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dts::device::labjack {
namespace {

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::uint8_t kFast = 0x08;
constexpr std::uint8_t kDivided = 0x02;

core::Rate rate(std::int64_t scans, std::int64_t seconds = 1) { return *core::Rate::create(scans, seconds); }

void expect_clock(core::Rate wanted, std::uint8_t scan_config, std::uint16_t interval, core::Rate exact) {
  const ScanClock clock = nearest_clock(wanted);
  EXPECT_EQ(clock.scan_config, scan_config) << wanted.hz();
  EXPECT_EQ(clock.interval, interval) << wanted.hz();
  EXPECT_EQ(clock.rate, exact) << wanted.hz();
}

TEST(U6Timing, EachRate_NearestIntervalOfTheFastestClockThatReachesIt) {
  expect_clock(rate(100), 0, 40'000, rate(100));
  expect_clock(rate(1000), kFast, 48'000, rate(1000));
  expect_clock(rate(1500), kFast, 32'000, rate(1500));
  expect_clock(rate(10), kFast | kDivided, 18'750, rate(10));
  expect_clock(rate(1), kDivided, 15'625, rate(1));
  // where an interval ends
  expect_clock(rate(48'000'000, 65'535), kFast, 65'535, rate(48'000'000, 65'535));
  expect_clock(rate(732), 0, 5464, rate(4'000'000, 5464));
  expect_clock(rate(4'000'000, 65'535), 0, 65'535, rate(4'000'000, 65'535));
  expect_clock(rate(61), kFast | kDivided, 3074, rate(187'500, 3074));
  expect_clock(rate(15'625, 65'535), kDivided, 65'535, rate(15'625, 65'535));
  // 48 MHz / 1001 and / 1002: 47952.05 and 47904.19 Hz
  expect_clock(rate(47'930), kFast, 1001, rate(48'000'000, 1001));
  expect_clock(rate(47'927), kFast, 1002, rate(48'000'000, 1002));
}

TEST(U6Timing, NearestRate_NoOtherIntervalIsNearer) {
  for (double hz = 0.3; hz < 50'000.0; hz *= 1.037) {
    const core::Rate wanted = *core::Rate::from_hz(hz);
    const ScanClock clock = nearest_clock(wanted);
    const double clock_hz = clock.rate.hz() * clock.interval;
    const double error = std::abs(clock.rate.hz() - wanted.hz());
    EXPECT_LE(error, std::abs(clock_hz / (clock.interval + 1) - wanted.hz())) << hz;
    EXPECT_LE(error, clock.interval > 1 ? std::abs(clock_hz / (clock.interval - 1) - wanted.hz()) : 1e9) << hz;
  }
}

TEST(U6Timing, FullSpeed_IsNeverExceededByRounding) {
  for (std::size_t channels = 1; channels <= 25; ++channels) {
    const core::Rate wanted = rate(50'000, static_cast<std::int64_t>(channels));
    const double samples = nearest_clock(wanted).rate.hz() * static_cast<double>(channels);
    EXPECT_LE(samples, 50'000.0 * (1 + 1e-12)) << channels;
    EXPECT_GE(samples, 49'900.0) << channels;
  }
}

TEST(U6Timing, Packing_WholeScansOrFullPacketsWithinTheLatency) {
  const auto expect_packing = [](const Packing& packing, std::size_t samples, std::size_t packets, std::int64_t period_ns) {
    EXPECT_EQ(packing.samples_per_packet, samples);
    EXPECT_EQ(packing.packets_per_transfer, packets);
    EXPECT_EQ(packing.transfer_period_ns, period_ns);
  };
  expect_packing(pack(rate(100), 4, 10 * kMillisecond, false), 4, 1, 10 * kMillisecond);
  expect_packing(pack(rate(1500), 11, 10 * kMillisecond, false), 25, 6, 150 * 1'000'000'000LL / 16'500);  // 165 samples in 10 ms
  expect_packing(pack(rate(100), 4, 10 * kMillisecond, true), 25, 1, 62'500'000);                         // asked for large ones
  EXPECT_EQ(pack(rate(100), 4, 25 * kMillisecond, false).samples_per_packet, 8U);
  EXPECT_EQ(pack(rate(100), 11, 20 * kMillisecond, false).samples_per_packet, 22U);
  EXPECT_EQ(pack(rate(1), 17, 0, false).samples_per_packet, 17U);
  // without latency no more than a packet per USB frame
  EXPECT_EQ(pack(rate(20'000), 1, 0, false).samples_per_packet, 20U);
  EXPECT_EQ(pack(rate(50'000), 1, 0, false).samples_per_packet, 25U);
}

}  // namespace
}  // namespace dts::device::labjack
