// SPDX-License-Identifier: Apache-2.0
#include "core/clock.h"

#include <gtest/gtest.h>

#include <deque>
#include <latch>
#include <thread>

namespace dts::core {
namespace {

TEST(VirtualClock, SleepAndAdvance_MoveItForwardOnly) {
  VirtualClock clock{100};

  clock.sleep_until_ns(250);
  EXPECT_EQ(clock.now_ns(), 250);
  for (const std::int64_t past_ns : {249, 250, -1}) clock.sleep_until_ns(past_ns);
  EXPECT_EQ(clock.now_ns(), 250);
  clock.advance_ns(3);
  EXPECT_EQ(clock.now_ns(), 253);
}

TEST(VirtualClock, SlewedWallClock_MovesNowAndNotRaw) {
  VirtualClock clock{1000};
  const std::int64_t raw_ns = clock.raw_ns();

  clock.slew_ns(300);

  EXPECT_EQ(clock.raw_ns(), raw_ns);
  EXPECT_EQ(monotonic_of_raw_ns(clock, raw_ns), clock.now_ns());
}

/// Says what it was given, reading by reading.
class ScriptedClock final : public Clock {
 public:
  ScriptedClock(std::deque<std::int64_t> raw, std::deque<std::int64_t> now) : raw_(std::move(raw)), now_(std::move(now)) {}
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return next(now_); }
  [[nodiscard]] std::int64_t raw_ns() const noexcept override { return next(raw_); }
  void sleep_until_ns(std::int64_t) noexcept override {}
  [[nodiscard]] bool is_read_out() const { return raw_.empty() && now_.empty(); }

 private:
  static std::int64_t next(std::deque<std::int64_t>& readings) {
    const std::int64_t value = readings.front();
    readings.pop_front();
    return value;
  }
  mutable std::deque<std::int64_t> raw_, now_;
};

TEST(MonotonicOfRaw, IsByTheReadingThatTookTheLeastTime_OfAtMostFour) {
  const ScriptedClock quiet({0, 20'000}, {500'000});
  EXPECT_EQ(monotonic_of_raw_ns(quiet, 7), 490'007);
  EXPECT_TRUE(quiet.is_read_out()) << "20 us are good enough";
  const ScriptedClock busy({0, 90'000, 100'000, 130'000, 200'000, 290'000, 300'000, 390'000}, {500'000, 600'000, 1'700'000, 1'800'000});
  EXPECT_EQ(monotonic_of_raw_ns(busy, 7), 600'000 - 115'000 + 7);
  EXPECT_TRUE(busy.is_read_out());
}

/// Whether `monotonic_of_raw_ns` is right to a tenth of a millisecond.
bool is_same_moment(const SystemClock& clock) {
  constexpr std::int64_t kReadingNs = 100'000;
  const std::int64_t before_ns = clock.now_ns();
  const std::int64_t raw_ns = clock.raw_ns();
  const std::int64_t after_ns = clock.now_ns();
  const std::int64_t now_ns = monotonic_of_raw_ns(clock, raw_ns);
  return now_ns > before_ns - kReadingNs && now_ns < after_ns + kReadingNs;
}

TEST(SystemClock, RawInstant_IsTheMonotonicTimeOfTheSameMoment) {
  const SystemClock clock;

  bool is_same = false;
  for (int tries = 0; !is_same && tries < 1000; ++tries) is_same = is_same_moment(clock);  // a busy machine disturbs most of them

  EXPECT_TRUE(is_same);
}

TEST(VirtualClock, ManySleepers_NeverTurnItBack) {
  VirtualClock clock;
  std::latch both_run{2};
  constexpr std::int64_t kSteps = 1'000'000;

  const auto sleep_in_steps_of = [&](std::int64_t step_ns) {
    both_run.arrive_and_wait();
    for (std::int64_t i = 0; i < kSteps; ++i) {
      const std::int64_t deadline_ns = clock.now_ns() + step_ns;
      clock.sleep_until_ns(deadline_ns);
      ASSERT_GE(clock.now_ns(), deadline_ns) << "another sleeper has turned it back";
    }
  };
  std::thread other(sleep_in_steps_of, 3);
  sleep_in_steps_of(2);
  other.join();
}

TEST(VirtualClock, AdvancedByTwoThreads_LosesNothing) {
  VirtualClock clock;
  std::latch both_run{2};
  constexpr int kSteps = 1'000'000;

  const auto advance = [&] {
    both_run.arrive_and_wait();
    for (int i = 0; i < kSteps; ++i) clock.advance_ns(1);
  };
  std::thread other(advance);
  advance();
  other.join();

  EXPECT_EQ(clock.now_ns(), 2 * kSteps);
}

TEST(SystemClock, SleepUntil_ReturnsAtOrAfterTheDeadline) {
  SystemClock clock;
  for (const std::int64_t ahead_ns : {100'000, -1}) {
    const std::int64_t deadline_ns = clock.now_ns() + ahead_ns;
    clock.sleep_until_ns(deadline_ns);
    EXPECT_GE(clock.now_ns(), deadline_ns);
  }
}

TEST(UtcMinusMonotonic, AddedToMonotonic_IsThisCentury) {
  constexpr std::int64_t kYear2020_ns = 1'577'836'800LL * 1'000'000'000;
  constexpr std::int64_t kYear2100_ns = 4'102'444'800LL * 1'000'000'000;

  const std::int64_t utc_ns = SystemClock{}.now_ns() + SystemClock{}.utc_minus_monotonic_ns();

  EXPECT_GT(utc_ns, kYear2020_ns);
  EXPECT_LT(utc_ns, kYear2100_ns);
}

}  // namespace
}  // namespace dts::core
