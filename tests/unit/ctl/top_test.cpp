// SPDX-License-Identifier: Apache-2.0
// The daemon's health for people and programs: quantiles out of its histogram, and `dtsctl top`.
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "ctl/health_view.h"
#include "ctl/latency.h"
#include "ctl/screen.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

using testing::floor_status;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Blocks that took no longer than 1, 2 and 10 ms, and all.
v1::LatencyHistogram histogram(const std::array<std::uint64_t, 4>& totals) {
  v1::LatencyHistogram made;
  const std::array bounds{1.0, 2.0, 10.0, kInfinity};
  for (std::size_t index = 0; index < bounds.size(); ++index) {
    made.add_buckets()->set_upper_ms(bounds[index]);
    made.mutable_buckets()->rbegin()->set_blocks_total(totals[index]);
  }
  return made;
}

TEST(LatencyQuantile, WithinABucket_IsSpreadEvenlyAndAboveTheLastBoundIsThatBound) {
  EXPECT_FALSE(latency_quantile_ms({}, 0.5));
  EXPECT_FALSE(latency_quantile_ms(histogram({0, 0, 0, 0}), 0.5));
  for (const auto& [part, expected_ms] : {std::pair(0.5, 2.0), {0.25, 1.5}, {0.75, 6.0}}) {
    EXPECT_DOUBLE_EQ(*latency_quantile_ms(histogram({0, 50, 100, 100}), part), expected_ms);
  }
  EXPECT_DOUBLE_EQ(*latency_quantile_ms(histogram({0, 0, 10, 100}), 0.95), 10.0);
}

TEST(LatencyQuantile, SinceAnEarlierState_CountsOnlyWhatCameAfter) {
  const v1::LatencyHistogram earlier = histogram({0, 0, 1000, 1000});
  const v1::LatencyHistogram of_another_daemon = histogram({500, 500, 500, 500});

  EXPECT_FALSE(latency_quantile_ms(earlier, 0.5, &earlier));
  EXPECT_DOUBLE_EQ(*latency_quantile_ms(histogram({10, 10, 1010, 1010}), 0.5, &earlier), 0.5);
  EXPECT_DOUBLE_EQ(*latency_quantile_ms(histogram({10, 10, 10, 10}), 0.5, &of_another_daemon), 0.5) << "does not fit: is no state";
}

TEST(LatencyQuantile, NonsenseFromAPeer_IsANumberOrNothing) {
  v1::LatencyHistogram falling = histogram({90, 50, 10, 100});
  EXPECT_TRUE(std::isfinite(*latency_quantile_ms(falling, 0.95)));
  falling.mutable_buckets(0)->set_upper_ms(kInfinity);
  static_cast<void>(latency_quantile_ms(falling, 0.5));  // ends
}

v1::StatusSnapshot busy_status(std::int64_t host_time_s = 100, std::uint64_t blocks = 100) {
  v1::StatusSnapshot status = floor_status();
  status.set_host_time_ns(host_time_s * 1'000'000'000);
  v1::RigStatus& rig = *status.mutable_rigs(0);
  rig.set_lost_scans_total(150);
  rig.set_gaps_total(1);
  rig.set_pipeline_us_per_scan(12.5);
  v1::LossCount& loss = *rig.add_losses();
  loss.set_reason(v1::GAP_REASON_OVERRUN);
  loss.set_gaps_total(1);
  loss.set_lost_scans_total(150);
  rig.mutable_ring_fill()->set_record_percent(40.0);
  *rig.mutable_latency() = histogram({0, blocks, blocks, blocks});
  return status;
}

TEST(HealthView, BeforeTheFirstStatus_SaysNothing) {
  EXPECT_TRUE(HealthView().lines(200).empty());
  EXPECT_TRUE(HealthView().json().empty());
}

TEST(HealthView, Latency_IsOfTheLastTenSeconds) {
  HealthView view;
  view.update(busy_status(100, 1000));
  v1::StatusSnapshot slow = busy_status(105, 1000);
  slow.mutable_rigs(0)->mutable_latency()->mutable_buckets(2)->set_blocks_total(1100);
  slow.mutable_rigs(0)->mutable_latency()->mutable_buckets(3)->set_blocks_total(1100);
  view.update(slow);

  EXPECT_DOUBLE_EQ(view.json().at("rigs").at(0).at("latency_p50_ms").get<double>(), 6.0) << "the slow hundred, not the thousand before";

  slow.set_host_time_ns(130'000'000'000);
  view.update(slow);
  EXPECT_LT(view.json().at("rigs").at(0).at("latency_p50_ms").get<double>(), 2.0)
      << "nothing else is left to compare with: since the start";
}

TEST(HealthView, SessionThatFailed_IsShownWithItsMessage) {
  v1::StatusSnapshot status = busy_status();
  v1::SessionInfo& session = *status.mutable_rigs(0)->mutable_session();
  session.set_session_id("s7");
  session.set_message("the disk is full");
  const auto shown = [&status](v1::SessionState state) {
    status.mutable_rigs(0)->mutable_session()->set_state(state);
    HealthView view;
    view.update(status);
    return cli::join(view.lines(200), "\n");
  };
  EXPECT_THAT(shown(v1::SESSION_STATE_FAILED), ::testing::HasSubstr("s7 failed: the disk is full"));
  EXPECT_THAT(shown(v1::SESSION_STATE_RUNNING), ::testing::HasSubstr("s7 running"));
  EXPECT_THAT(shown(v1::SESSION_STATE_IDLE), ::testing::Not(::testing::HasSubstr("s7")));
}

TEST(HealthView, AnotherDaemon_StartsAnew) {
  HealthView view;
  view.update(busy_status(100, 1000));
  v1::StatusSnapshot other = busy_status(101, 2000);
  other.set_instance_id(8);
  other.mutable_rigs(0)->mutable_latency()->mutable_buckets(0)->set_blocks_total(2000);

  view.update(other);

  EXPECT_LT(view.json().at("rigs").at(0).at("latency_p95_ms").get<double>(), 1.0);
}

class ScreenTest : public ::testing::Test {
 protected:
  std::string printed() {
    std::string text = out_.str();
    out_.str({});
    return text;
  }
  std::ostringstream out_;
  std::ostringstream talk_;
  cli::Console console_{.out = out_, .talk = talk_, .can_redraw = true, .columns = 6, .lines = 4};
  Screen screen_{console_};
};

TEST_F(ScreenTest, NewLines_AreDrawnOverTheOldOnes) {
  screen_.draw({"first", "x"});
  EXPECT_EQ(printed(), "first\nx\n");
  screen_.draw({"x\x1b[2J"});
  EXPECT_EQ(printed(), "\x1b[2A\x1b[Jx [2J\n");
  screen_.make_room();
  screen_.draw({"below"});
  EXPECT_EQ(printed(), "below\n");
}

TEST_F(ScreenTest, LongLines_AreWrappedAndTheLastOnesLeftOut) {
  screen_.draw({"ab cd ef", "second", "third"});

  EXPECT_EQ(printed(), "ab cd\n  ef\nsecond\n");
}

TEST_F(ScreenTest, ResizedTerminal_IsErasedWhole) {
  screen_.draw({"first"});
  printed();
  console_.measure = [](cli::Console& console) { console.columns = 3; };

  screen_.draw({"abcd"});
  EXPECT_EQ(printed(), "\x1b[H\x1b[Jabc\n  d\n");
  screen_.draw({"x"});
  EXPECT_EQ(printed(), "\x1b[2A\x1b[Jx\n");
}

}  // namespace
}  // namespace dts::ctl
