// SPDX-License-Identifier: Apache-2.0
#include "core/host_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "support/committed_text.h"
#include "unit/core/late_arrivals.h"

namespace dts::core {
namespace {

using test::kMillisecond;
using test::Machine;

constexpr std::int64_t kFrameNs = kMillisecond;

Rate rate_1500() { return *Rate::create(40'000'000, 26'667); }

class HostTimeOfClock : public testing::TestWithParam<double> {};

TEST_P(HostTimeOfClock, IsWithinOneMillisecondAfterAMinuteAndKnowsTheDriftAfterFive) {
  Machine machine{.rate = rate_1500(), .clock_error = GetParam() * 1e-6};
  HostTime time(machine.rate, kFrameNs);
  machine.run(time, 60.0);
  for (int second = 60; second < 300; ++second) {
    machine.run(time, 1.0);
    const double error_ms = std::abs(machine.error_ms(time));
    ASSERT_LT(error_ms, 1.0) << "after " << second << " s";
    ASSERT_LT(error_ms, static_cast<double>(time.uncertainty_ns()) * 1e-6);
  }
  EXPECT_NEAR(time.drift_ppm(), GetParam(), 5.0);
  EXPECT_LT(std::abs(time.rate_error()), 0.001);
}

INSTANTIATE_TEST_SUITE_P(Clocks, HostTimeOfClock, testing::Values(-80.0, 0.0, 80.0));

TEST(HostTime, IsWithinItsUncertaintyFromTheFirstArrivalOn) {
  RecordProperty("requirement", "ACQ-10");
  Machine machine{.rate = *Rate::create(100, 1), .clock_error = 80e-6, .scans_per_transfer = 1};
  HostTime time(machine.rate, kFrameNs);
  for (int i = 0; i < 6000; ++i) {
    machine.run(time, 0.01);
    const double error_ms = std::abs(machine.error_ms(time));
    ASSERT_LT(error_ms, static_cast<double>(time.uncertainty_ns()) * 1e-6) << "scan " << i;
  }
}

TEST(HostTime, StalledAtTheStart_SaysHowLittleItKnows) {
  for (const std::int64_t stall_ms : {0, 20, 150}) {
    Machine machine{.rate = rate_1500(), .clock_error = 80e-6, .busy_ms = 1.0};
    HostTime time(machine.rate, kFrameNs);
    time.restart(machine.truth_ns(0) - kMillisecond);
    machine.last_arrival_ns = machine.truth_ns(0) + stall_ms * kMillisecond;
    for (int i = 0; i < 300; ++i) {
      machine.run(time, 0.02);
      const double error_ms = std::abs(machine.error_ms(time));
      ASSERT_LT(error_ms, static_cast<double>(time.uncertainty_ns()) * 1e-6) << stall_ms << " ms, block " << i;
    }
    EXPECT_LT(time.uncertainty_ns(), 4 * kMillisecond);
  }
}

TEST(HostTime, ClockThatIsFarTooFast_IsDriftAndNoLoss) {
  for (const double ppm : {200.0, 600.0, 2000.0, 9000.0}) {
    Machine machine{.rate = rate_1500(), .clock_error = ppm * 1e-6, .busy_ms = 1.0};
    HostTime time(machine.rate, kFrameNs);
    for (int second = 0; second < 120; ++second) {
      machine.run(time, 1.0);
      ASSERT_FALSE(time.has_loss()) << ppm << " ppm after " << second << " s";
      ASSERT_LT(std::abs(time.rate_error()), 0.01) << ppm;
    }
    EXPECT_NEAR(time.drift_ppm(), ppm, 100.0);
  }
}

TEST(HostTime, NeverGoesBack) {
  RecordProperty("requirement", "ACQ-10");
  Machine machine{.rate = rate_1500(), .clock_error = 120e-6, .busy_ms = 20.0};
  HostTime time(machine.rate, kFrameNs);
  std::int64_t last_ns = 0;
  for (int i = 0; i < 3000; ++i) {
    machine.run(time, 0.02);
    const std::int64_t now_ns = time.at({machine.next - 1});
    ASSERT_GT(now_ns, last_ns);
    last_ns = now_ns;
  }
}

TEST(HostTime, HasNoEstimateBeforeTheFirstArrival) {
  HostTime time(rate_1500(), kFrameNs);
  EXPECT_FALSE(time.has_estimate());
  EXPECT_EQ(time.at({17}), 0);
  time.add({29}, test::kFirstScanNs);
  EXPECT_TRUE(time.has_estimate());
  EXPECT_EQ(time.at({29}), test::kFirstScanNs);
}

TEST(HostTime, KeepsTheDriftOverAGap) {
  Machine machine{.rate = rate_1500(), .clock_error = 80e-6};
  HostTime time(machine.rate, kFrameNs);
  machine.run(time, 200.0);
  const double known_ppm = time.drift_ppm();
  time.restart();
  EXPECT_FALSE(time.has_estimate());
  EXPECT_EQ(time.drift_ppm(), known_ppm);
  Machine after{.rate = rate_1500(), .clock_error = 80e-6};
  after.run(time, 5.0);
  EXPECT_LT(std::abs(after.error_ms(time)), 1.0);
  EXPECT_EQ(time.drift_ppm(), known_ppm);
}

TEST(HostTime, TellsADeviceThatRunsAtAnotherRate) {
  for (const double factor : {0.125, 0.97, 1.03, 2.0}) {
    Machine machine{.rate = rate_1500(), .clock_error = factor - 1.0};
    HostTime time(machine.rate, kFrameNs);
    machine.run(time, 5.0 * factor);
    EXPECT_GT(std::abs(time.rate_error()), 0.01) << factor;
    EXPECT_EQ(time.rate_error() < 0.0, factor > 1.0);
    machine.run(time, 15.0);
    EXPECT_NEAR(time.drift_ppm(), factor > 1.0 ? 10'000.0 : -10'000.0, 1e-6) << "no crystal is further off";
  }
}

/// 100 scans a second in one arrival each `every` seconds, whose lateness is known; times in ns after the first arrival.
struct KnownArrivals {
  explicit KnownArrivals(std::uint64_t every) : scans(100 * every) {}
  void add(double late_ms) {
    newest += scans;
    time.add({newest}, test::kFirstScanNs + static_cast<std::int64_t>(newest) * 10 * kMillisecond + std::llround(late_ms * 1e6));
  }
  HostTime time{*Rate::create(100, 1), kFrameNs};
  std::uint64_t scans;
  std::uint64_t newest = 0;
};

TEST(HostTime, JudgesTheRateOnceTwoSecondsLieBetweenArrivals) {
  KnownArrivals slow(1);
  for (int second = 1; second <= 3; ++second) {
    slow.add(100.0 * second);  // every second takes 1.1
    EXPECT_EQ(slow.time.rate_error(), 0.0);
    EXPECT_EQ(slow.time.missing_ns(), 0);
  }
  slow.add(400.0);
  EXPECT_NEAR(slow.time.rate_error(), 0.1 - 0.01, 1e-9) << "less what 20 ms of bad luck in 2 s could feign";
}

TEST(HostTime, LineIsTheEdgeUnderTheMiddleOfTheArrivals) {
  KnownArrivals arrivals(2);
  for (const double late_ms : {0.0, 5.0, 0.2, 6.0, 0.4}) arrivals.add(late_ms);
  EXPECT_NEAR(static_cast<double>(arrivals.time.uncertainty_ns()), 1e6 + 2 * 11.2e6 / 4 + 200e-6 * 6e9, 1.0)
      << "the drift is not known yet";
  arrivals.add(7.0);
  EXPECT_EQ(arrivals.time.drift_ppm(), 0.0);
  arrivals.add(0.6);  // the line through 0, 0.2 and 0.4 ms; 10 s lie between the first arrival and 7.0

  EXPECT_NEAR(arrivals.time.drift_ppm(), -50.0, 1e-6);
  EXPECT_NEAR(static_cast<double>(arrivals.time.uncertainty_ns()), 1e6 + 2 * (4.9e6 + 5.7e6 + 6.5e6) / 6, 1.0);
  EXPECT_NEAR(static_cast<double>(arrivals.time.at({1400}) - test::kFirstScanNs), 14e9 + 0.6e6, 1.0);
}

TEST(HostTime, IsNotImpressedByAStallOfTheMachine) {
  Machine machine{.rate = rate_1500(), .busy_ms = 1.0};
  HostTime time(machine.rate, kFrameNs);
  machine.run(time, 20.0);
  machine.last_arrival_ns += 2000 * kMillisecond;  // everything of two seconds comes at once
  machine.run(time, 10.0);
  EXPECT_LT(std::abs(machine.error_ms(time)), 0.5);
  EXPECT_LT(time.missing_ns(), kMillisecond);
  EXPECT_LT(std::abs(time.rate_error()), 0.001);
}

/// The host sleeps for 10 min. The device continues, and counts the scans that nobody reads.
TEST(HostTime, ClockThatStoodStill_RestartsTheEstimateAndKeepsTheDrift) {
  Machine machine{.rate = rate_1500(), .clock_error = 80e-6, .busy_ms = 1.0};
  HostTime time(machine.rate, kFrameNs);
  machine.run(time, 60.0);
  const std::int64_t before_ns = time.at({machine.next - 1});
  const double drift_ppm = time.drift_ppm();
  machine.next += 900'000;
  machine.lost -= 900'000;  // wraps: these indices have no time by the host's clock
  for (int transfer = 0; transfer < 50 * 60; ++transfer) {
    machine.step(time);
    const std::int64_t now_ns = time.at({machine.next - 1});
    ASSERT_GT(now_ns, before_ns);
    ASSERT_LE(now_ns, machine.last_arrival_ns) << "transfer " << transfer;
    ASSERT_LT(std::abs(machine.error_ms(time)), static_cast<double>(time.uncertainty_ns()) * 1e-6) << "transfer " << transfer;
    ASSERT_LT(std::abs(time.rate_error()), 0.001);
    ASSERT_NEAR(time.drift_ppm(), drift_ppm, 20.0);
    ASSERT_FALSE(time.has_loss());
  }
}

/// All that is known at many moments, against host_times.txt: of clocks that are off, a busy machine, a stall, a hole and a new segment.
TEST(HostTime, EveryFigureOfAStory_IsThatOfItsFile) {
  std::ostringstream text;
  text.precision(12);
  const auto us = [](std::int64_t ns) { return static_cast<double>(ns) / 1000.0; };
  for (const double ppm : {0.0, 80.0, -150.0, 3000.0, -12'000.0}) {
    Machine machine{.rate = rate_1500(), .clock_error = ppm * 1e-6, .busy_ms = 2.0};
    HostTime time(machine.rate, kFrameNs);
    const auto write = [&](const char* what) {
      text << what << " at scan " << machine.next << " : " << us(time.at({machine.next - 1}) - machine.truth_ns(machine.next - 1)) << " +- "
           << us(time.uncertainty_ns()) << " us off, drift " << time.drift_ppm() << " ppm, rate error " << time.rate_error()
           << " , missing " << us(time.missing_ns()) << " of " << us(time.least_loss_ns()) << (time.is_judged() ? " judged" : "")
           << (time.has_loss() ? " loss" : "") << '\n';
    };
    text << ppm << " ppm\n";
    time.restart(machine.truth_ns(0) - 3 * kMillisecond);
    for (const double seconds : {0.02, 0.5, 0.5, 1.0, 1.0, 2.0, 5.0, 2.0, 20.0, 300.0}) {
      machine.run(time, seconds);
      write("runs");
    }
    machine.last_arrival_ns += 500 * kMillisecond;
    machine.run(time, 1.0);
    write("has stalled");
    machine.lost += 20;
    for (int second = 0; second < 3; ++second) {
      machine.run(time, 1.0);
      write("has lost scans");
    }
    Machine again{.rate = rate_1500(), .clock_error = ppm * 1e-6, .busy_ms = 0.5};
    std::swap(machine, again);
    time.restart();
    for (const double seconds : {0.02, 3.0, 10.0}) {
      machine.run(time, seconds);
      write("new segment");
    }
  }
  dts::test::expect_committed("unit/core/host_times.txt", text.str(), 1e-5);  // nanoseconds are rounded
}

}  // namespace
}  // namespace dts::core
