// SPDX-License-Identifier: Apache-2.0
#include "device/sim/pacer.h"

#include <gtest/gtest.h>

namespace dts::device::sim {
namespace {

constexpr std::int64_t kStart = 5'000;

TEST(Pacer, Start_FirstScanIsTakenAtOnce) {
  const Pacer pacer(kStart, *core::Rate::create(100, 1), 0.0);

  EXPECT_EQ(pacer.instant_ns(0), kStart);
  EXPECT_EQ(pacer.taken_by(kStart - 1), 0U);
  EXPECT_EQ(pacer.taken_by(kStart), 1U);
}

TEST(Pacer, ThreeHours_NoDrift) {
  const Pacer pacer(kStart, *core::Rate::create(1500, 1), 0.0);

  EXPECT_EQ(pacer.instant_ns(std::uint64_t{3} * 3600 * 1500), kStart + std::int64_t{3} * 3600 * 1'000'000'000);
}

TEST(Pacer, FastClock_ScansComeEarlier) {
  const Pacer pacer(kStart, *core::Rate::create(100, 1), 50.0);

  EXPECT_EQ(pacer.instant_ns(100), kStart + 1'000'000'000 - 50'000);
}

TEST(Pacer, AnyRateAndError_TakenAgreesWithInstants) {
  for (const double ppm : {-1000.0, 0.0, 73.0, 1000.0}) {
    for (const auto& rate : {*core::Rate::create(1, 1), *core::Rate::create(4096000, 2730), *core::Rate::create(20000, 1)}) {
      const Pacer pacer(kStart, rate, ppm);
      for (const std::uint64_t scan : {1ULL, 2ULL, 999ULL, 123'456'789ULL}) {
        EXPECT_EQ(pacer.taken_by(pacer.instant_ns(scan) - 1), scan) << ppm;
        EXPECT_EQ(pacer.taken_by(pacer.instant_ns(scan)), scan + 1) << ppm;
      }
    }
  }
}

}  // namespace
}  // namespace dts::device::sim
