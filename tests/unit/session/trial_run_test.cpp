// SPDX-License-Identifier: Apache-2.0
#include "session/trial_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <sstream>

#include "core/clock.h"

namespace dts::session {
namespace {

using core::kNanosecondsPerSecond;

/// Two conditions in turn, two blocks of two. Ready for 2 s, settling for 5 s, measuring for 20 s, rest of 10 s, between blocks 60 s.
TrialPlan timed() {
  return {.conditions = {{.name = "a", .labels = {{"eyes", "open"}}}, {.name = "b", .target_percent = 150}},
          .trials_per_block = 2,
          .blocks = 2,
          .cue_delay_min_s = 2,
          .cue_delay_max_s = 2,
          .settle_s = 5,
          .duration_s = 20,
          .rest_s = 10,
          .block_rest_s = 60};
}
/// No times at all: every trial lasts from one `next` to the following.
TrialPlan untimed() { return {.conditions = {{.name = "a"}, {.name = "b"}}, .trials_per_block = 2}; }

/// "ready 1.1@0 go 1.1@2": kind, trial.attempt, second at which it was due.
std::string notices_of(TrialRun& run) {
  std::ostringstream text;
  for (const TrialEvent& event : run.take_events()) {
    text << (text.tellp() > 0 ? " " : "") << name(event.kind);
    if (event.trial != 0) text << ' ' << event.trial << '.' << event.attempt;
    text << '@' << static_cast<double>(event.at_ns) / kNanosecondsPerSecond;
  }
  return text.str();
}

core::ErrorCode code(const core::Status& status) { return status ? core::ErrorCode{} : status.error().code; }
constexpr auto kWrongState = core::ErrorCode::WrongState;

TrialPhase phase_at(const TrialRun& run, std::int64_t now_ns) { return run.view(now_ns).phase; }

TEST(TrialRun, Next_LeadsThroughAllPhases) {
  TrialRun run(timed(), 1, {});
  run.tick(100 * kNanosecondsPerSecond);
  EXPECT_EQ(notices_of(run), "");  // waits
  ASSERT_TRUE(run.next(0));
  run.tick(2 * kNanosecondsPerSecond - 1);
  EXPECT_EQ(notices_of(run), "ready 1.1@0");
  run.tick(2 * kNanosecondsPerSecond);
  EXPECT_EQ(phase_at(run, 2 * kNanosecondsPerSecond), TrialPhase::Settling);
  run.tick(7 * kNanosecondsPerSecond);
  EXPECT_EQ(phase_at(run, 7 * kNanosecondsPerSecond), TrialPhase::Measuring);
  run.tick(27 * kNanosecondsPerSecond);
  EXPECT_EQ(phase_at(run, 27 * kNanosecondsPerSecond), TrialPhase::Resting);
  run.tick(37 * kNanosecondsPerSecond);
  EXPECT_EQ(phase_at(run, 37 * kNanosecondsPerSecond), TrialPhase::Waiting);
  EXPECT_EQ(notices_of(run), "go 1.1@2 measure 1.1@7 done 1.1@27 rest 1.1@27");
}

TEST(TrialRun, Events_SayEverythingAboutTheTrial) {
  TrialRun run(timed(), 1, {{"arm_length_cm", "70"}});
  ASSERT_TRUE(run.next(0));
  run.tick(40 * kNanosecondsPerSecond);
  ASSERT_TRUE(run.next(40 * kNanosecondsPerSecond));
  const auto events = run.take_events();
  EXPECT_EQ(events[0].condition, "a");
  EXPECT_EQ(events[0].labels, (std::vector<std::pair<std::string, std::string>>{{"eyes", "open"}}));
  EXPECT_FALSE(events[0].target_cm.has_value());
  EXPECT_EQ(events[4].kind, TrialEventKind::Rest);
  EXPECT_EQ(events[4].rest_s, 10.0);
  EXPECT_EQ(events[5].condition, "b");
  EXPECT_DOUBLE_EQ(events[5].target_cm.value_or(0), 105.0);
  EXPECT_TRUE(run.take_events().empty());
}

TEST(TrialRun, BlockOver_RestsForTheBlock) {
  TrialRun run(timed(), 1, {});
  ASSERT_TRUE(run.next(0));
  ASSERT_TRUE(run.next(30 * kNanosecondsPerSecond));
  run.tick(57 * kNanosecondsPerSecond);
  EXPECT_DOUBLE_EQ(run.view(57 * kNanosecondsPerSecond).remaining_s, 60.0);
  EXPECT_EQ(run.take_events().back().rest_s, 60.0);
}

TEST(TrialRun, LateTick_PassesThroughSeveralPhasesWithoutDrift) {
  TrialRun run(timed(), 1, {});
  ASSERT_TRUE(run.next(0));
  run.tick(1000 * kNanosecondsPerSecond);
  EXPECT_EQ(notices_of(run), "ready 1.1@0 go 1.1@2 measure 1.1@7 done 1.1@27 rest 1.1@27");
  EXPECT_EQ(phase_at(run, 1000 * kNanosecondsPerSecond), TrialPhase::Waiting);
}

TEST(TrialRun, LateTickOfAPlanThatStartsByItself_RunsToTheEnd) {
  auto plan = timed();
  plan.starts_by_itself = true;
  TrialRun run(plan, 1, {});
  run.tick(500 * kNanosecondsPerSecond);
  EXPECT_EQ(notices_of(run), "");  // the first trial waits all the same
  ASSERT_TRUE(run.next(500 * kNanosecondsPerSecond));
  run.tick(5000 * kNanosecondsPerSecond);
  EXPECT_TRUE(run.is_finished());
  EXPECT_THAT(notices_of(run),
              testing::EndsWith("done 3.1@651 rest 3.1@651 ready 4.1@661 go 4.1@663 measure 4.1@668 done 4.1@688 finished@688"));
}

TEST(TrialRun, ManySmallTicks_TellTheSameAsOneLate) {
  auto plan = timed();
  plan.starts_by_itself = true;
  TrialRun patient(plan, 1, {});
  TrialRun late(plan, 1, {});
  ASSERT_TRUE(patient.next(0));
  ASSERT_TRUE(late.next(0));
  for (std::int64_t now_ns = 0; now_ns <= 300 * kNanosecondsPerSecond; now_ns += 7'000'003) patient.tick(now_ns);
  patient.tick(300 * kNanosecondsPerSecond);
  late.tick(300 * kNanosecondsPerSecond);
  EXPECT_EQ(notices_of(patient), notices_of(late));
}

TEST(TrialRun, NoTimes_EveryNextEndsOrStartsATrial) {
  TrialRun run(untimed(), 1, {});
  ASSERT_TRUE(run.next(1 * kNanosecondsPerSecond));
  EXPECT_EQ(phase_at(run, kNanosecondsPerSecond), TrialPhase::Measuring);
  EXPECT_EQ(run.view(kNanosecondsPerSecond).remaining_s, 0.0);
  run.tick(1000 * kNanosecondsPerSecond);
  ASSERT_TRUE(run.next(1001 * kNanosecondsPerSecond));
  EXPECT_EQ(phase_at(run, 1001 * kNanosecondsPerSecond), TrialPhase::Waiting);
  ASSERT_TRUE(run.next(1002 * kNanosecondsPerSecond));
  ASSERT_TRUE(run.next(1003 * kNanosecondsPerSecond));
  EXPECT_EQ(notices_of(run),
            "ready 1.1@1 go 1.1@1 measure 1.1@1 done 1.1@1001 ready 2.1@1002 go 2.1@1002 measure 2.1@1002 done 2.1@1003 finished@1003");
  EXPECT_TRUE(run.is_finished());
  EXPECT_EQ(code(run.next(1004 * kNanosecondsPerSecond)), kWrongState);
}

TEST(TrialRun, NoTimesAndStartingByItself_TheEndOfATrialIsTheStartOfTheNext) {
  auto plan = untimed();
  plan.starts_by_itself = true;
  TrialRun run(plan, 1, {});
  ASSERT_TRUE(run.next(0));
  ASSERT_TRUE(run.next(kNanosecondsPerSecond));
  EXPECT_EQ(notices_of(run), "ready 1.1@0 go 1.1@0 measure 1.1@0 done 1.1@1 ready 2.1@1 go 2.1@1 measure 2.1@1");
}

TEST(TrialRun, DurationBelowANanosecond_EndsAWholePlanWithoutNesting) {
  TrialPlan plan{.conditions = {{.name = "a"}}, .trials_per_block = kMostTrials, .starts_by_itself = true, .duration_s = 1e-15};
  TrialRun run(plan, 1, {});
  ASSERT_TRUE(run.next(0));
  run.tick(kNanosecondsPerSecond);
  EXPECT_TRUE(run.is_finished());
  EXPECT_EQ(run.take_events().size(), std::size_t{4} * kMostTrials + 1);
}

TEST(TrialRun, NextInEachPhase_WorksOnlyWhereNothingIsCut) {
  TrialRun run(timed(), 1, {});
  ASSERT_TRUE(run.next(0));
  EXPECT_EQ(code(run.next(1 * kNanosecondsPerSecond)), kWrongState);   // ready
  EXPECT_EQ(code(run.next(3 * kNanosecondsPerSecond)), kWrongState);   // settling
  EXPECT_EQ(code(run.next(10 * kNanosecondsPerSecond)), kWrongState);  // measuring for a fixed time
  ASSERT_TRUE(run.next(28 * kNanosecondsPerSecond));                   // resting: cut short
  EXPECT_EQ(run.view(28 * kNanosecondsPerSecond).trial, 2U);
  EXPECT_EQ(phase_at(run, 28 * kNanosecondsPerSecond), TrialPhase::Ready);
}

/// A run in each phase of its first trial, with its notices until then removed.
void in_each_phase(const std::function<void(TrialRun&, std::int64_t now_ns, const std::string& at)>& test) {
  const std::vector<std::pair<std::string, std::int64_t>> moments{
      {"ready", 1}, {"settling", 3}, {"measuring", 10}, {"resting", 30}, {"waiting", 50}};
  for (const auto& [phase, second] : moments) {
    SCOPED_TRACE(phase);
    TrialRun run(timed(), 1, {});
    ASSERT_TRUE(run.next(0));
    const std::int64_t now_ns = second * kNanosecondsPerSecond;
    run.tick(now_ns);
    ASSERT_EQ(name(phase_at(run, now_ns)), phase);
    static_cast<void>(run.take_events());
    test(run, now_ns, "@" + std::to_string(second));
  }
}

TEST(TrialRun, Redo_StartsTheSamePlaceAgainAsAnotherAttempt) {
  in_each_phase([](TrialRun& run, std::int64_t now_ns, const std::string& at) {
    ASSERT_TRUE(run.redo(now_ns));

    EXPECT_EQ(notices_of(run), "redone 1.1" + at + " ready 1.2" + at);
    EXPECT_EQ(phase_at(run, now_ns), TrialPhase::Ready);
    run.tick(now_ns + 1000 * kNanosecondsPerSecond);
    ASSERT_TRUE(run.next(now_ns + 1000 * kNanosecondsPerSecond));
    EXPECT_EQ(run.view(now_ns + 1000 * kNanosecondsPerSecond).trial, 2U);
    EXPECT_EQ(run.view(now_ns + 1000 * kNanosecondsPerSecond).attempt, 1U);
  });
}

TEST(TrialRun, Reject_GoesOnWithTheNextPlace) {
  in_each_phase([](TrialRun& run, std::int64_t now_ns, const std::string& at) {
    ASSERT_TRUE(run.reject(now_ns));

    EXPECT_THAT(notices_of(run), testing::StartsWith("rejected 1.1" + at));
    EXPECT_EQ(code(run.reject(now_ns)), kWrongState);
    EXPECT_EQ(code(run.redo(now_ns)), kWrongState);
    ASSERT_TRUE(run.next(now_ns));
    EXPECT_EQ(notices_of(run), "ready 2.1" + at);
    EXPECT_TRUE(run.redo(now_ns));  // the new one is not void
  });
}

TEST(TrialRun, Abort_TellsOnlyATrialUnderWayAndEndsEverything) {
  in_each_phase([](TrialRun& run, std::int64_t now_ns, const std::string& at) {
    run.abort(now_ns);
    run.abort(now_ns);

    EXPECT_EQ(notices_of(run), now_ns < 27 * kNanosecondsPerSecond ? "aborted 1.1" + at : "");
    EXPECT_EQ(code(run.next(now_ns)), kWrongState);
    EXPECT_EQ(code(run.redo(now_ns)), kWrongState);
    EXPECT_EQ(code(run.reject(now_ns)), kWrongState);
    run.tick(now_ns + 1000 * kNanosecondsPerSecond);
    EXPECT_EQ(notices_of(run), "");
    EXPECT_FALSE(run.is_finished());
  });
}

TEST(TrialRun, NothingStartedYet_CannotBeVoidedOrAborted) {
  TrialRun run(timed(), 1, {});
  EXPECT_EQ(code(run.redo(0)), kWrongState);
  EXPECT_EQ(code(run.reject(0)), kWrongState);
  run.abort(0);
  EXPECT_EQ(notices_of(run), "");
}

TEST(TrialRun, RejectedUnderWay_RestsBeforeTheNext) {
  auto plan = timed();
  plan.starts_by_itself = true;
  TrialRun run(plan, 1, {});
  ASSERT_TRUE(run.next(0));
  ASSERT_TRUE(run.reject(3 * kNanosecondsPerSecond));
  run.tick(13 * kNanosecondsPerSecond);
  EXPECT_EQ(notices_of(run), "ready 1.1@0 go 1.1@2 rejected 1.1@3 rest 1.1@3 ready 2.1@13");
}

TEST(TrialRun, RejectedWhileResting_TheRestGoesOn) {
  TrialRun run(timed(), 1, {});
  ASSERT_TRUE(run.next(0));
  ASSERT_TRUE(run.reject(30 * kNanosecondsPerSecond));
  EXPECT_EQ(phase_at(run, 30 * kNanosecondsPerSecond), TrialPhase::Resting);
  EXPECT_DOUBLE_EQ(run.view(30 * kNanosecondsPerSecond).remaining_s, 7.0);
}

TEST(TrialRun, RedoTwice_CountsAttempts) {
  TrialRun run(untimed(), 1, {});
  ASSERT_TRUE(run.next(0));
  ASSERT_TRUE(run.redo(0));
  ASSERT_TRUE(run.redo(0));
  EXPECT_EQ(run.view(0).attempt, 3U);
  ASSERT_TRUE(run.next(0));
  ASSERT_TRUE(run.next(0));
  EXPECT_EQ(run.view(0).trial, 2U);
  EXPECT_EQ(run.view(0).attempt, 1U);
}

TEST(TrialRun, Redo_DrawsAnotherDelayOfTheCue) {
  auto plan = timed();
  plan.cue_delay_max_s = 3600;  // that two of 3.6 million are the same is not what this seed gives
  TrialRun run(plan, 5, {});
  ASSERT_TRUE(run.next(0));
  const double first_s = run.view(0).remaining_s;
  EXPECT_DOUBLE_EQ(first_s, make_plan(plan, 5)[0].cue_delay_s);
  ASSERT_TRUE(run.redo(0));
  EXPECT_NE(run.view(0).remaining_s, first_s);
}

TEST(TrialRun, LastTrialDone_CanStillBeRedone) {
  TrialRun run(untimed(), 1, {});
  for (int call = 0; call < 4; ++call) ASSERT_TRUE(run.next(0));
  ASSERT_TRUE(run.is_finished());
  ASSERT_TRUE(run.redo(kNanosecondsPerSecond));
  EXPECT_FALSE(run.is_finished());
  EXPECT_EQ(run.view(kNanosecondsPerSecond).trial, 2U);
  ASSERT_TRUE(run.next(2 * kNanosecondsPerSecond));
  EXPECT_TRUE(run.is_finished());
}

TEST(TrialRun, LastTrialRejected_StaysFinishedAndIsToldOnce) {
  TrialRun run(untimed(), 1, {});
  for (int call = 0; call < 4; ++call) ASSERT_TRUE(run.next(0));
  static_cast<void>(run.take_events());
  ASSERT_TRUE(run.reject(kNanosecondsPerSecond));
  EXPECT_EQ(notices_of(run), "rejected 2.1@1");
  EXPECT_TRUE(run.is_finished());
}

TEST(TrialRun, AbortAfterTheTimeWasOver_TheTrialIsDone) {
  TrialRun run(timed(), 1, {});
  ASSERT_TRUE(run.next(0));
  run.abort(28 * kNanosecondsPerSecond);  // nobody called tick since
  EXPECT_THAT(notices_of(run), testing::EndsWith("done 1.1@27 rest 1.1@27"));
}

TEST(TrialRun, DoneInEarlierParts_IsPassedOver) {
  TrialRun run(timed(), 1, {}, {1, 3, 0, 99, 4'000'000'000U});
  EXPECT_EQ(run.view(0).trial, 0U);
  EXPECT_EQ(run.view(0).of, 4U);
  EXPECT_EQ(run.view(0).next_condition, "b");
  EXPECT_EQ(code(run.redo(0)), kWrongState);  // what an earlier part recorded is not this one's to void
  ASSERT_TRUE(run.next(0));
  EXPECT_EQ(run.view(0).trial, 2U);
  run.tick(27 * kNanosecondsPerSecond);
  EXPECT_EQ(run.take_events().back().rest_s, 60.0);  // the next place lies in another block
  ASSERT_TRUE(run.next(30 * kNanosecondsPerSecond));
  EXPECT_EQ(run.view(30 * kNanosecondsPerSecond).trial, 4U);
  run.tick(100 * kNanosecondsPerSecond);
  EXPECT_TRUE(run.is_finished());
}

TEST(TrialRun, AllDoneInEarlierParts_IsFinishedFromTheStart) {
  TrialRun run(untimed(), 1, {}, {2, 1});
  EXPECT_TRUE(run.is_finished());
  EXPECT_EQ(notices_of(run), "finished@0");
  EXPECT_EQ(code(run.next(0)), kWrongState);
}

TEST(TrialRun, EmptyPlan_IsFinishedFromTheStart) {
  TrialRun run({}, 1, {});
  EXPECT_TRUE(run.is_finished());
  EXPECT_EQ(run.view(0).of, 0U);
  run.tick(kNanosecondsPerSecond);
  run.abort(kNanosecondsPerSecond);
}

TEST(TrialRun, View_KnowsWhatComesNext) {
  TrialRun run(timed(), 1, {{"arm_length_cm", "70"}});
  EXPECT_EQ(run.view(0).next_condition, "a");
  EXPECT_EQ(run.view(0).block, 1U);
  ASSERT_TRUE(run.next(0));
  const auto view = run.view(kNanosecondsPerSecond);
  EXPECT_EQ(view.condition, "a");
  EXPECT_EQ(view.next_condition, "b");
  EXPECT_DOUBLE_EQ(view.next_target_cm.value_or(0), 105.0);
  EXPECT_DOUBLE_EQ(view.remaining_s, 1.0);
  EXPECT_EQ(run.view(100 * kNanosecondsPerSecond).remaining_s, 0.0);  // never negative, even before tick
}

TEST(TrialRun, TimeGoingBack_ChangesNothing) {
  TrialRun run(timed(), 1, {});
  ASSERT_TRUE(run.next(10 * kNanosecondsPerSecond));
  run.tick(0);
  EXPECT_EQ(phase_at(run, 0), TrialPhase::Ready);
}

}  // namespace
}  // namespace dts::session
