// SPDX-License-Identifier: Apache-2.0
// The board's ticks against its counter, over hours.
#include "device/board/timeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/units.h"
#include "unit/device/sim_rig.h"

namespace dts::device::board {
namespace {

constexpr std::int64_t kArrivalNs = 20 * core::kNanosecondsPerMillisecond;

/// A board that scans at 1000 Hz, more or less, and sends frames of 10 scans with ticks.
struct TickingBoard {
  explicit TickingBoard(std::uint32_t ticks_in_a_second) : ticks_per_second(ticks_in_a_second) {
    timeline.start(test::rate_of(1000.0), ticks_in_a_second, false, std::nullopt);
  }
  /// Adds the next frame, whose first scan is `late_s` later than the counter says.
  bool add(double late_s = 0.0) {
    const double time_s = static_cast<double>(number) / 1000.0 / speed + late_s;
    const auto ticks = static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::llround(time_s * ticks_per_second)));
    arrived_ns = static_cast<std::int64_t>(time_s * 1e9) + kArrivalNs - asleep_ns;
    const bool is_right = timeline.add(number, ticks, 10, arrived_ns);
    number += step;
    return is_right;
  }

  Timeline timeline;
  std::uint32_t ticks_per_second;
  double speed = 1.0;  ///< 1.005: 0.5 % faster than nominal.
  std::uint64_t number = 0;
  std::uint64_t step = 10;
  std::int64_t asleep_ns = 0;  ///< For how long the host's clock has stood still.
  std::int64_t arrived_ns = 0;
};

TEST(BoardTimeline, Position_FollowsTheTicksForADay) {
  for (const double speed : {0.995, 1.0, 1.005}) {
    TickingBoard board(16'000'000);  // they wrap every 268 s
    board.speed = speed;
    board.step = 100;
    while (board.number < 86'400'000) {
      const double time_s = static_cast<double>(board.number) / 1000.0 / speed;
      ASSERT_TRUE(board.add()) << time_s;
      ASSERT_NEAR(static_cast<double>(board.timeline.position(0)) / 16e6, time_s, 1e-3) << speed;
    }
    EXPECT_NEAR(board.timeline.drift_ppm(), (speed - 1.0) * 1e6, 1.0);
  }
}

TEST(BoardTimeline, HoleThatNobodyCounted_IsFoundAlsoAfterHours) {
  TickingBoard board(1'000'000);
  while (board.number < 10'800'000) ASSERT_TRUE(board.add());
  TickingBoard jittering = board;
  EXPECT_TRUE(jittering.add(0.04)) << "a board may scan in an uneven loop";
  EXPECT_FALSE(board.add(0.1));
}

TEST(BoardTimeline, ManySmallHoles_AreFoundTogether) {
  TickingBoard board(1'000'000);
  double late_s = 0.0;
  bool is_right = true;
  while (is_right && board.number < 3'600'000) {
    if (board.number % 1000 == 0) late_s += 0.03;
    is_right = board.add(late_s);
  }
  EXPECT_FALSE(is_right);
  EXPECT_LE(board.number, 20'000U) << "3 % of the scans are missing: found within some seconds";
}

TEST(BoardTimeline, LowRate_MayJitterByLessThanAPeriod) {
  Timeline timeline;
  timeline.start(test::rate_of(1.0), 1'000'000, false, std::nullopt);
  const auto add = [&](std::uint32_t number, double time_s) {
    return timeline.add(number, static_cast<std::uint32_t>(time_s * 1e6), 1, static_cast<std::int64_t>(time_s * 1e9) + kArrivalNs);
  };
  for (std::uint32_t number = 0; number < 100; ++number) ASSERT_TRUE(add(number, number + (number % 5 == 2 ? 0.6 : 0.0))) << number;
  EXPECT_FALSE(add(100, 101.0)) << "one scan is missing";
}

TEST(BoardTimeline, CountedLoss_AcrossAWrapOfTheTicks_IsNoHole) {
  TickingBoard board(16'000'000);
  board.speed = 1.005;
  while (board.number < 600'000) ASSERT_TRUE(board.add());
  board.number += 600'000;  // 10 min, more than two turns
  const double time_s = static_cast<double>(board.number) / 1000.0 / board.speed;
  ASSERT_TRUE(board.add());
  EXPECT_NEAR(static_cast<double>(board.timeline.position(0)) / 16e6, time_s, 1e-3);
}

TEST(BoardTimeline, CountedLossWhileTheHostSleeps_ContinuesAtTheTimeOfTheHost) {
  for (const std::uint32_t ticks_per_second : {1'000'000U, 0U}) {
    TickingBoard board(ticks_per_second);
    while (board.number < 60'000) ASSERT_TRUE(board.add());
    board.number += 600'000;
    board.asleep_ns = 600 * core::kNanosecondsPerSecond;
    while (board.number < 720'000) {
      ASSERT_TRUE(board.add());
      ASSERT_NEAR(static_cast<double>(board.timeline.raw_ns_at(board.timeline.position(9))), static_cast<double>(board.arrived_ns), 10e6);
      ASSERT_LT(std::abs(board.timeline.host_time().rate_error()), 0.001);
      ASSERT_LT(std::abs(board.timeline.drift_ppm()), 1.0);
    }
  }
}

}  // namespace
}  // namespace dts::device::board
