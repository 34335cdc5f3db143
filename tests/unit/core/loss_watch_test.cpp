// SPDX-License-Identifier: Apache-2.0
// Holes in streams that have no counter, by what HostTime makes of their arrivals. Synthetic arrivals in virtual time.
#include "core/loss_watch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "core/host_time.h"
#include "unit/core/late_arrivals.h"

namespace dts::core {
namespace {

using test::kMillisecond;
using test::Machine;

constexpr double kToldWithinSeconds = 3.0;
constexpr double kGoalMs = 5.0;

/// A device, a host, and the moment at which scans go missing.
struct LossCase {
  Machine machine;
  double hole_at_s = 0.0;
  std::string group;

  [[nodiscard]] double hole_ms(std::uint64_t scans) const { return 1e3 * static_cast<double>(scans) / machine.rate.hz(); }
  /// 5 ms, or one scan.
  [[nodiscard]] std::uint64_t goal_scans() const { return static_cast<std::uint64_t>(std::ceil(kGoalMs * 1e-3 * machine.rate.hz())); }
};

/// A case anywhere between 4 x 100 Hz and 8 x 1500 Hz; a quarter of the holes in the first second of the segment, a quarter in the next
/// ten.
LossCase random_case(std::mt19937_64& random) {
  constexpr std::array<std::int64_t, 6> kRatesHz{100, 150, 250, 500, 1000, 1500};
  const auto uniform = [&random](double least, double most) { return std::uniform_real_distribution<double>(least, most)(random); };
  LossCase made;
  made.machine.rate = *Rate::create(kRatesHz[random() % kRatesHz.size()], 1);
  made.machine.clock_error = uniform(-100e-6, 100e-6);
  const auto most_scans = std::max<std::uint64_t>(1, made.machine.rate.scans_in_ms(25.0));
  made.machine.scans_per_transfer = 1 + random() % most_scans;
  const std::uint64_t host = random() % 3;
  made.machine.busy_ms = host == 0 ? 0.3 : uniform(2.0, 8.0);
  made.machine.waiting_percent = host == 2 ? 50 + static_cast<unsigned>(random() % 45) : 50;
  made.machine.random.seed(random());
  const std::uint64_t when = random() % 4;
  made.hole_at_s = when == 0 ? uniform(0.1, 1.0) : when == 1 ? uniform(1.0, 11.0) : uniform(11.0, 600.0);
  constexpr std::array<const char*, 3> kHosts{"quiet", "busy", "overloaded"};
  const char* const moment = when == 0 ? "first second" : when == 1 ? "to 11 s" : "to 10 min";
  made.group = std::string(kHosts[host]) + (made.machine.rate.hz() > 200.0 ? ", 250 to 1500 Hz, " : ", 100 and 150 Hz, ") + moment;
  return made;
}

/// Seconds from the hole to the moment at which it was told; nothing within three.
bool is_told(Machine machine, HostTime time, std::uint64_t hole_scans) {
  const std::uint64_t until = machine.next + static_cast<std::uint64_t>(kToldWithinSeconds * machine.rate.hz()) - hole_scans;
  machine.lost += hole_scans;
  while (machine.next + machine.scans_per_transfer <= until) {
    machine.step(time);
    if (time.has_loss()) return true;
  }
  return false;
}

/// Of a group of cases.
struct SmallestHole {
  int cases = 0;
  double told_ms = 0.0;    ///< In every case, and all larger ones.
  double untold_ms = 0.0;  ///< In some case.
};

TEST(LossWatch, HolesAtAnyMoment_ToldWithinThreeSeconds) {
  RecordProperty("requirement", "ACQ-7");
  std::mt19937_64 random{19};
  std::map<std::string, SmallestHole> table;
  for (int i = 0; i < 200; ++i) {
    LossCase tried = random_case(random);
    HostTime time(tried.machine.rate, kMillisecond);
    tried.machine.run(time, tried.hole_at_s);
    ASSERT_FALSE(time.has_loss()) << "case " << i << ", before the hole";
    const std::uint64_t must_be_told = tried.goal_scans();
    EXPECT_TRUE(is_told(tried.machine, time, must_be_told))
        << "case " << i << ": " << tried.hole_ms(must_be_told) << " ms at " << tried.hole_at_s << " s, " << tried.machine.rate.hz()
        << " Hz, " << tried.machine.scans_per_transfer << " scans a transfer, " << tried.machine.clock_error * 1e6 << " ppm, host busy for "
        << tried.machine.busy_ms << " ms in " << tried.machine.waiting_percent << " % of the cases";
    std::uint64_t smallest = must_be_told;
    while (smallest > 1 && is_told(tried.machine, time, smallest - 1)) --smallest;
    SmallestHole& row = table[tried.group];
    ++row.cases;
    row.told_ms = std::max(row.told_ms, tried.hole_ms(smallest));
    row.untold_ms = std::max(row.untold_ms, tried.hole_ms(smallest - 1));
  }
  std::printf("%-42s %6s %20s %15s\n", "host, rate, moment of the hole", "cases", "always told within 3 s", "largest not told");
  for (const auto& [group, row] : table) {
    std::printf("%-42s %6d %19.2f ms %12.2f ms\n", group.c_str(), row.cases, row.told_ms, row.untold_ms);
  }
}

TEST(LossWatch, NothingLost_NothingToldInTenMinutes) {
  std::mt19937_64 random{20};
  double highest_ms = 0.0;
  for (int i = 0; i < 200; ++i) {
    LossCase tried = random_case(random);
    HostTime time(tried.machine.rate, kMillisecond);
    const std::uint64_t until = tried.machine.rate.scans_in_ms(600e3);
    while (tried.machine.next < until) {
      tried.machine.step(time);
      highest_ms = std::max(highest_ms, static_cast<double>(time.missing_ns()) * 1e-6);
      ASSERT_FALSE(time.has_loss()) << "case " << i << " after " << static_cast<double>(tried.machine.next) / tried.machine.rate.hz()
                                    << " s";
    }
  }
  std::printf("highest rise without a loss, 200 cases of 10 min: %.2f ms\n", highest_ms);
}

TEST(LossWatch, HostThatIsBusyNowAndThen_NothingTold) {
  std::mt19937_64 random{21};
  for (int i = 0; i < 200; ++i) {
    LossCase tried = random_case(random);
    if (tried.machine.waiting_percent > 50) continue;  // overloaded: daemon/device/usb/README.md has those figures
    HostTime time(tried.machine.rate, kMillisecond);
    const double busy_ms = tried.machine.busy_ms;
    for (int spell = 0; spell < 8; ++spell) {
      tried.machine.busy_ms = spell % 2 == 0 ? 0.3 : std::max(busy_ms, 2.0);
      const std::uint64_t until = tried.machine.next + tried.machine.rate.scans_in_ms(10e3 + static_cast<double>(random() % 20'000));
      while (tried.machine.next < until) {
        tried.machine.step(time);
        ASSERT_FALSE(time.has_loss()) << "case " << i << ", spell " << spell;
      }
    }
  }
}

TEST(LossWatch, HoleDoesNotPassForDrift) {
  Machine machine{.rate = *Rate::create(1500, 1), .scans_per_transfer = 4, .busy_ms = 0.3};
  HostTime time(machine.rate, kMillisecond);
  machine.run(time, 4.0);
  machine.lost += 60;  // 40 ms
  machine.run(time, 2.9);
  EXPECT_TRUE(time.has_loss());
  EXPECT_NEAR(static_cast<double>(time.missing_ns()), 40e6, 1.5e6);
}

TEST(LossWatch, ScansThatTrickleAway_AreToldToo) {
  Machine machine{.rate = *Rate::create(1500, 1), .scans_per_transfer = 4, .busy_ms = 0.3};
  HostTime time(machine.rate, kMillisecond);
  int seconds = 0;
  for (; seconds < 20 && !time.has_loss(); ++seconds) {  // one scan a second: 667 ppm
    machine.run(time, 1.0);
    ++machine.lost;
  }
  EXPECT_LT(seconds, 12);
}

TEST(LossWatch, ClockSlowerThanAnyCrystal_LooksLikeLostScans) {
  for (const double ppm : {-600.0, -2000.0, -9000.0}) {
    Machine machine{.rate = *Rate::create(1500, 1), .clock_error = ppm * 1e-6, .busy_ms = 0.3};
    HostTime time(machine.rate, kMillisecond);
    machine.run(time, 13.0);
    EXPECT_TRUE(time.has_loss()) << ppm;
  }
}

TEST(LossWatch, ClockWithAResonator_IsNoLossAndDoesNotHideOne) {
  std::mt19937_64 random{22};
  for (int i = 0; i < 200; ++i) {
    LossCase tried = random_case(random);
    if (tried.machine.waiting_percent > 50) continue;  // overloaded
    tried.machine.clock_error *= 50.0;                 // up to 0.5 %
    HostTime time(tried.machine.rate, kMillisecond, HostTime::Oscillator::Resonator);
    const std::uint64_t until = tried.machine.rate.scans_in_ms(60e3);
    while (tried.machine.next < until) {
      tried.machine.step(time);
      ASSERT_FALSE(time.has_loss()) << "case " << i << ", " << tried.machine.clock_error * 1e6 << " ppm, after "
                                    << static_cast<double>(tried.machine.next) / tried.machine.rate.hz() << " s";
    }
    EXPECT_TRUE(is_told(tried.machine, time, tried.machine.rate.scans_in_ms(100.0))) << "case " << i;
  }
}

TEST(LossWatch, HostThatStoppedForSeconds_IsNoLoss) {
  for (const double stop_s : {0.5, 2.0, 4.0, 20.0}) {
    Machine machine{.rate = *Rate::create(1500, 1), .scans_per_transfer = 4, .busy_ms = 0.3};
    HostTime time(machine.rate, kMillisecond);
    machine.run(time, 5.0);
    machine.last_arrival_ns += std::llround(stop_s * 1e9);  // all of it comes at once
    for (int i = 0; i < 40; ++i) {
      machine.run(time, 1.0);
      ASSERT_FALSE(time.has_loss()) << stop_s << " s, " << i << " s later";
    }
  }
}

}  // namespace
}  // namespace dts::core
