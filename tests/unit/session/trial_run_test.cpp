// SPDX-License-Identifier: Apache-2.0
#include "session/trial_run.h"

#include <gtest/gtest.h>

#include <cmath>
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

TrialPlan with_rest(TrialPlan plan, double rest_s) {
  plan.rest_s = rest_s;
  return plan;
}
TrialPlan by_itself(TrialPlan plan) {
  plan.starts_by_itself = true;
  return plan;
}

const std::vector<std::pair<std::string, std::string>> kArm{{"arm_length_cm", "70"}};

/// "ready 1.1a@0 go 1.1a@2": kind, trial.attempt, condition and second at which it was due; a rest with its length, a target with its
/// distance.
std::string notices_of(TrialRun& run) {
  std::ostringstream text;
  for (const TrialEvent& event : run.take_events()) {
    text << ' ' << name(event.kind);
    if (event.trial != 0) text << ' ' << event.trial << '.' << event.attempt << event.condition;
    text << '@' << static_cast<double>(event.at_ns) / kNanosecondsPerSecond;
    if (event.rest_s != 0.0) text << '(' << event.rest_s << "s)";
    if (event.kind == TrialEventKind::Ready && event.target_cm) text << '(' << *event.target_cm << "cm)";
  }
  return text.str();
}

/// "waiting 1.1a of 4, next 2b at 105 cm, 0 s".
std::string view_of(const TrialRun& run, std::int64_t now_ns) {
  const TrialView view = run.view(now_ns);
  std::ostringstream text;
  text << name(view.phase) << ' ' << view.trial << '.' << view.attempt << view.condition << " of " << view.of << " block " << view.block;
  if (view.next_trial != 0) text << ", next " << view.next_trial << view.next_condition;
  if (view.next_target_cm) text << " at " << *view.next_target_cm << " cm";
  text << ", " << view.remaining_s << " s" << (run.is_finished() ? ", finished" : "");
  return text.str();
}

/// What a run says while the commands are given: "next@0 tick@7"; a "!" before a command expects that it is refused.
std::string told(TrialRun& run, const std::string& commands) {
  std::istringstream words(commands);
  std::string all;
  std::int64_t now_ns = 0;
  for (std::string word; words >> word;) {
    const bool is_refusal = word[0] == '!';
    const std::string command = word.substr(is_refusal ? 1 : 0, word.find('@') - (is_refusal ? 1 : 0));
    now_ns = std::llround(std::stod(word.substr(word.find('@') + 1)) * kNanosecondsPerSecond);
    core::Status status;
    if (command == "next") status = run.next(now_ns);
    if (command == "redo") status = run.redo(now_ns);
    if (command == "reject") status = run.reject(now_ns);
    if (command == "undo") status = run.undo(now_ns);
    if (command == "tick") run.tick(now_ns);
    if (command == "abort") run.abort(now_ns);
    EXPECT_EQ(!status, is_refusal) << word << " of " << commands;
    EXPECT_TRUE(status || status.error().code == core::ErrorCode::WrongState) << word;
    all += notices_of(run);
  }
  return all + " | " + view_of(run, now_ns);
}

struct Script {
  const char* why;
  TrialPlan plan;
  std::string commands;
  std::string told;
  std::vector<EarlierTrial> earlier{};  ///< In earlier parts.
};

TEST(TrialRun, Commands_LeadThroughThePhasesAndTheWholePlan) {
  RecordProperty("requirement", "SES-1");
  for (
      const auto& [why, plan, commands, expected, earlier] : std::vector<Script>{
          {"waits for the first command", timed(), "tick@100", " | waiting 0.1 of 4 block 1, next 1a, 0 s"},
          {"all phases", timed(), "next@0 tick@1.999999999 tick@2 tick@7 tick@27 tick@37",
           " ready 1.1a@0 go 1.1a@2 measure 1.1a@7 done 1.1a@27 rest 1.1a@27(10s) | waiting 1.1a of 4 block 1, next 2b at 105 cm, 0 s"},
          {"settling", timed(), "next@0 tick@2", " ready 1.1a@0 go 1.1a@2 | settling 1.1a of 4 block 1, next 2b at 105 cm, 5 s"},
          {"measuring", timed(), "next@0 tick@7",
           " ready 1.1a@0 go 1.1a@2 measure 1.1a@7 | measuring 1.1a of 4 block 1, next 2b at 105 cm, 20 s"},
          {"resting", timed(), "next@0 tick@27",
           " ready 1.1a@0 go 1.1a@2 measure 1.1a@7 done 1.1a@27 rest 1.1a@27(10s) | resting 1.1a of 4 block 1, next 2b at 105 cm, 10 s"},
          {"remaining time", timed(), "next@0 tick@1", " ready 1.1a@0 | ready 1.1a of 4 block 1, next 2b at 105 cm, 1 s"},
          {"a late tick passes through phases without drift", timed(), "next@0 tick@1000",
           " ready 1.1a@0 go 1.1a@2 measure 1.1a@7 done 1.1a@27 rest 1.1a@27(10s) | waiting 1.1a of 4 block 1, next 2b at 105 cm, 0 s"},
          {"a block over rests for the block", timed(), "next@0 next@30 tick@57",
           " ready 1.1a@0 go 1.1a@2 measure 1.1a@7 done 1.1a@27 rest 1.1a@27(10s) ready 2.1b@30(105cm) go 2.1b@32 measure 2.1b@37 done "
           "2.1b@57 rest 2.1b@57(60s) | resting 2.1b of 4 block 1, next 3a, 60 s"},
          {"starts by itself, all but the first", by_itself(timed()), "tick@500 next@500 tick@5000",
           " ready 1.1a@500 go 1.1a@502 measure 1.1a@507 done 1.1a@527 rest 1.1a@527(10s) ready 2.1b@537(105cm) go 2.1b@539 measure "
           "2.1b@544 done 2.1b@564 rest 2.1b@564(60s) ready 3.1a@624 go 3.1a@626 measure 3.1a@631 done 3.1a@651 rest 3.1a@651(10s) ready "
           "4.1b@661(105cm) go 4.1b@663 measure 4.1b@668 done 4.1b@688 finished@688 | finished 4.1b of 4 block 2, 0 s, finished"},
          {"without times, next ends or starts a trial", untimed(), "next@1 tick@1000 next@1001 next@1002 next@1003 !next@1004",
           " ready 1.1a@1 go 1.1a@1 measure 1.1a@1 done 1.1a@1001 ready 2.1b@1002 go 2.1b@1002 measure 2.1b@1002 done 2.1b@1003 "
           "finished@1003 | finished 2.1b of 2 block 1, 0 s, finished"},
          {"without times and by itself", by_itself(untimed()), "next@0 next@1",
           " ready 1.1a@0 go 1.1a@0 measure 1.1a@0 done 1.1a@1 ready 2.1b@1 go 2.1b@1 measure 2.1b@1 | measuring 2.1b of 2 block 1, 0 s"},
          {"next cuts nothing but a rest", timed(), "next@0 !next@1 !next@3 !next@10 next@28",
           " ready 1.1a@0 go 1.1a@2 measure 1.1a@7 done 1.1a@27 rest 1.1a@27(10s) ready 2.1b@28(105cm) | ready 2.1b of 4 block 1, next 3a, "
           "2 s"},
          {"nothing to void yet", timed(), "!redo@0 !reject@0 abort@0", " | waiting 0.1 of 4 block 1, next 1a, 0 s"},
          {"rejected under way: rests before the next", by_itself(timed()), "next@0 reject@3 tick@13",
           " ready 1.1a@0 go 1.1a@2 rejected 1.1a@3 rest 1.1a@3(10s) ready 2.1b@13(105cm) | ready 2.1b of 4 block 1, next 3a, 2 s"},
          {"rejected while resting: the rest goes on", timed(), "next@0 reject@30",
           " ready 1.1a@0 go 1.1a@2 measure 1.1a@7 done 1.1a@27 rest 1.1a@27(10s) rejected 1.1a@30 | resting 1.1a of 4 block 1, next 2b at "
           "105 cm, 7 s"},
          {"redone twice", untimed(), "next@0 redo@0 redo@0",
           " ready 1.1a@0 go 1.1a@0 measure 1.1a@0 redone 1.1a@0 ready 1.2a@0 go 1.2a@0 measure 1.2a@0 redone 1.2a@0 ready 1.3a@0 go "
           "1.3a@0 measure 1.3a@0 | measuring 1.3a of 2 block 1, next 2b, 0 s"},
          {"attempts count anew in the next", untimed(), "next@0 redo@0 redo@0 next@0 next@0",
           " ready 1.1a@0 go 1.1a@0 measure 1.1a@0 redone 1.1a@0 ready 1.2a@0 go 1.2a@0 measure 1.2a@0 redone 1.2a@0 ready 1.3a@0 go "
           "1.3a@0 measure 1.3a@0 done 1.3a@0 ready 2.1b@0 go 2.1b@0 measure 2.1b@0 | measuring 2.1b of 2 block 1, 0 s"},
          {"the last can still be redone", untimed(), "next@0 next@0 next@0 next@0 redo@1",
           " ready 1.1a@0 go 1.1a@0 measure 1.1a@0 done 1.1a@0 ready 2.1b@0 go 2.1b@0 measure 2.1b@0 done 2.1b@0 finished@0 redone 2.1b@1 "
           "ready 2.2b@1 go 2.2b@1 measure 2.2b@1 | measuring 2.2b of 2 block 1, 0 s"},
          {"and is then done", untimed(), "next@0 next@0 next@0 next@0 redo@1 next@2",
           " ready 1.1a@0 go 1.1a@0 measure 1.1a@0 done 1.1a@0 ready 2.1b@0 go 2.1b@0 measure 2.1b@0 done 2.1b@0 finished@0 redone 2.1b@1 "
           "ready 2.2b@1 go 2.2b@1 measure 2.2b@1 done 2.2b@2 finished@2 | finished 2.2b of 2 block 1, 0 s, finished"},
          {"the last rejected stays finished, reported once", untimed(), "next@0 next@0 next@0 next@0 reject@1",
           " ready 1.1a@0 go 1.1a@0 measure 1.1a@0 done 1.1a@0 ready 2.1b@0 go 2.1b@0 measure 2.1b@0 done 2.1b@0 finished@0 rejected "
           "2.1b@1 | finished 2.1b of 2 block 1, 0 s, finished"},
          {"aborted after its time: done", timed(), "next@0 abort@28",
           " ready 1.1a@0 go 1.1a@2 measure 1.1a@7 done 1.1a@27 rest 1.1a@27(10s) | waiting 1.1a of 4 block 1, next 2b at 105 cm, 0 s"},
          {"time goes back", timed(), "next@10 tick@0", " ready 1.1a@10 | ready 1.1a of 4 block 1, next 2b at 105 cm, 12 s"},
          {"no plan", {}, "tick@1 abort@1", " finished@0 | finished 0.1 of 0 block 1, 0 s, finished"},
          {"earlier parts: none shown yet, not this one's to void",
           timed(),
           "!redo@0",
           " | waiting 0.1 of 4 block 1, next 2b at 105 cm, 0 s",
           {{1, 1, true}, {3, 2, true}, {0, 1, true}, {99, 1, true}, {4'000'000'000U, 1, true}}},
          {"earlier parts: passed over",
           timed(),
           "next@0 tick@27 next@30 tick@100",
           " ready 2.1b@0(105cm) go 2.1b@2 measure 2.1b@7 done 2.1b@27 rest 2.1b@27(60s) ready 4.1b@30(105cm) go 4.1b@32 measure 4.1b@37 "
           "done 4.1b@57 finished@57 | finished 4.1b of 4 block 2, 0 s, finished",
           {{1, 1, true}, {3, 1, true}}},
          {"earlier parts: attempts continue their numbers",
           timed(),
           "next@0 redo@1 undo@2 redo@2.5",
           " ready 2.4b@0(105cm) redone 2.4b@1 ready 2.5b@1(105cm) undone 2.4b@2 redone 2.4b@2.5 ready 2.6b@2.5(105cm) | ready 2.6b of 4 "
           "block "
           "1, next 3a, 2 s",
           {{1, 1, true}, {2, 3, false}}},
          {"all in earlier parts",
           untimed(),
           "!next@0",
           " finished@0 | finished 0.1 of 2 block 1, 0 s, finished",
           {{2, 1, true}, {1, 5, true}}},
      }) {
    TrialRun run(plan, 1, kArm, earlier);
    EXPECT_EQ(told(run, commands), expected) << why;
  }
}

TEST(TrialRun, Undo_ContinuesTheAttemptAsIfNothingHadHappened) {
  RecordProperty("requirement", "SES-3");
  const std::string to_measuring = " ready 1.1a@0 go 1.1a@2 measure 1.1a@7";
  const std::string to_rest = to_measuring + " done 1.1a@27 rest 1.1a@27(10s)";
  const std::string next_b = " of 4 block 1, next 2b at 105 cm, ";
  for (const auto& [why, plan, commands, expected, earlier] : std::vector<Script>{
           {"nothing to take back", timed(), "!undo@0 next@0 !undo@1", " ready 1.1a@0 | ready 1.1a" + next_b + "1 s"},
           {"measuring continues", timed(), "next@0 reject@10 undo@12 tick@27",
            to_measuring + " rejected 1.1a@10 rest 1.1a@10(10s) undone 1.1a@12 done 1.1a@27 rest 1.1a@27(10s) | resting 1.1a" + next_b +
                "10 s"},
           {"its time is over: done, and the rest begins now", timed(), "next@0 reject@26 undo@30",
            to_measuring + " rejected 1.1a@26 rest 1.1a@26(10s) undone 1.1a@30 done 1.1a@27 rest 1.1a@30(10s) | resting 1.1a" + next_b +
                "10 s"},
           {"settling was over meanwhile: measures since then", timed(), "next@0 reject@6 undo@10",
            " ready 1.1a@0 go 1.1a@2 rejected 1.1a@6 rest 1.1a@6(10s) undone 1.1a@10 measure 1.1a@7 | measuring 1.1a" + next_b + "17 s"},
           {"a cue is not given in the past", timed(), "next@0 reject@1 undo@4 tick@5",
            " ready 1.1a@0 rejected 1.1a@1 rest 1.1a@1(10s) undone 1.1a@4 go 1.1a@5 | settling 1.1a" + next_b + "5 s"},
           {"after 5 s", timed(), "next@0 reject@10 !undo@15",
            to_measuring + " rejected 1.1a@10 rest 1.1a@10(10s) | resting 1.1a" + next_b + "5 s"},
           {"after the next trial has begun", timed(), "next@0 reject@10 next@11 !undo@12",
            to_measuring + " rejected 1.1a@10 rest 1.1a@10(10s) ready 2.1b@11(105cm) | ready 2.1b of 4 block 1, next 3a, 1 s"},
           {"twice", timed(), "next@0 reject@10 undo@11 !undo@12",
            to_measuring + " rejected 1.1a@10 rest 1.1a@10(10s) undone 1.1a@11 | measuring 1.1a" + next_b + "15 s"},
           {"after the session", timed(), "next@0 reject@10 abort@11 !undo@12",
            to_measuring + " rejected 1.1a@10 rest 1.1a@10(10s) | waiting 1.1a" + next_b + "0 s"},
           {"redo, and again with a new number", timed(), "next@0 redo@10 undo@11 tick@27 redo@28",
            to_measuring +
                " redone 1.1a@10 ready 1.2a@10 undone 1.1a@11 done 1.1a@27 rest 1.1a@27(10s) redone 1.1a@28 ready 1.3a@28 | ready 1.3a" +
                next_b + "2 s"},
           {"redo whose attempt has ended", untimed(), "next@0 redo@0 next@1 !undo@2",
            " ready 1.1a@0 go 1.1a@0 measure 1.1a@0 redone 1.1a@0 ready 1.2a@0 go 1.2a@0 measure 1.2a@0 done 1.2a@1 | waiting 1.2a of 2 "
            "block "
            "1, next 2b, 0 s"},
           {"a rest continues", timed(), "next@0 reject@30 undo@31",
            to_rest + " rejected 1.1a@30 undone 1.1a@31 rest 1.1a@31(7s) | resting 1.1a" + next_b + "7 s"},
           {"the end of the plan", untimed(), "next@0 next@0 next@0 reject@1 undo@2 next@3",
            " ready 1.1a@0 go 1.1a@0 measure 1.1a@0 done 1.1a@0 ready 2.1b@0 go 2.1b@0 measure 2.1b@0 rejected 2.1b@1 finished@1 undone "
            "2.1b@2 "
            "done 2.1b@3 finished@3 | finished 2.1b of 2 block 1, 0 s, finished"},
           {"a plan that starts by itself waits for it", by_itself(with_rest(timed(), 1)), "next@0 reject@10 tick@14.9 tick@15 !undo@15",
            to_measuring + " rejected 1.1a@10 rest 1.1a@10(5s) ready 2.1b@15(105cm) | ready 2.1b of 4 block 1, next 3a, 2 s"},
           {"also during a rest", by_itself(with_rest(timed(), 1)), "next@0 reject@27.5 tick@32.4 tick@32.5",
            to_measuring +
                " done 1.1a@27 rest 1.1a@27(1s) rejected 1.1a@27.5 rest 1.1a@27.5(5s) ready 2.1b@32.5(105cm) | ready 2.1b of 4 block 1, "
                "next 3a, 2 s"},
           {"a rest that was over meanwhile continues, too", by_itself(with_rest(timed(), 1)), "next@0 reject@27.5 undo@30",
            to_measuring +
                " done 1.1a@27 rest 1.1a@27(1s) rejected 1.1a@27.5 rest 1.1a@27.5(5s) undone 1.1a@30 rest 1.1a@30(0.5s) | resting 1.1a" +
                next_b + "0.5 s"},
       }) {
    TrialRun run(plan, 1, kArm, earlier);
    EXPECT_EQ(told(run, commands), expected) << why;
  }
}

/// "rejected 1.1, undo 3 s"; "" where no attempt has ended.
std::string end_of(const TrialRun& run, double now_s) {
  const TrialView view = run.view(std::llround(now_s * kNanosecondsPerSecond));
  std::ostringstream text;
  if (view.last_ended) text << name(view.last_ended->outcome) << ' ' << view.last_ended->trial << '.' << view.last_ended->attempt;
  if (view.undo_s > 0.0) text << ", undo " << view.undo_s << " s";
  return text.str();
}

TEST(TrialRun, View_ShowsHowTheNewestAttemptEnded) {
  TrialRun run(timed(), 1, kArm);
  (void)told(run, "next@0");
  EXPECT_EQ(end_of(run, 0), "");
  (void)told(run, "reject@10");
  EXPECT_EQ(end_of(run, 12), "rejected 1.1, undo 3 s");
  EXPECT_EQ(end_of(run, 15), "rejected 1.1");
  (void)told(run, "undo@12");
  EXPECT_EQ(end_of(run, 12), "");
  (void)told(run, "tick@27");
  EXPECT_EQ(end_of(run, 27), "done 1.1");
  (void)told(run, "redo@28");
  EXPECT_EQ(end_of(run, 28), "redone 1.1, undo 5 s");
  (void)told(run, "undo@29");
  EXPECT_EQ(end_of(run, 29), "done 1.1");
  (void)told(run, "next@30 abort@31");
  EXPECT_EQ(end_of(run, 31), "aborted 2.1");
}

TEST(TrialRun, View_HasTimesAndTargetOfTheCurrentTrial) {
  TrialRun run(timed(), 1, kArm);
  const TrialView before = run.view(0);
  EXPECT_EQ(before.settle_s, 5.0);
  EXPECT_EQ(before.duration_s, 20.0);
  EXPECT_FALSE(before.target_cm) << "of the first trial";
  EXPECT_FALSE(before.next_target_percent);
  (void)told(run, "next@0 next@30");
  const TrialView second = run.view(30 * kNanosecondsPerSecond);
  EXPECT_EQ(second.condition, "b");
  EXPECT_EQ(second.target_cm.value_or(0), 105.0);
  EXPECT_EQ(second.target_percent.value_or(0), 150.0);
  EXPECT_FALSE(second.next_target_cm);
  (void)told(run, "tick@57");
  EXPECT_FALSE(run.view(57 * kNanosecondsPerSecond).next_target_percent) << "the next condition has no target";
  (void)told(run, "next@120");
  EXPECT_EQ(run.view(120 * kNanosecondsPerSecond).next_target_percent.value_or(0), 150.0);
}

TEST(TrialRun, View_SaysWhetherTheSubjectSeesTheCop) {
  TrialPlan plan = timed();
  plan.conditions[1].labels.emplace_back("feedback", "cop");
  TrialRun run(plan, 1, kArm);
  EXPECT_FALSE(run.view(0).has_feedback) << "the first trial has none";
  (void)told(run, "next@0");
  EXPECT_FALSE(run.view(0).has_feedback) << "of the present trial, not of the next one";
  (void)told(run, "next@30");
  EXPECT_TRUE(run.view(30 * kNanosecondsPerSecond).has_feedback);
}

TEST(TrialPlanLength, IsTheSumOfAllTimesOrUnknown) {
  EXPECT_EQ(length_s(timed()).value_or(0), 4 * (2 + 5 + 20) + 10 + 60 + 10.0);
  EXPECT_FALSE(length_s(untimed()));
  EXPECT_FALSE(length_s({}));
  TrialPlan random = timed();
  random.cue_delay_max_s = 4;
  random.blocks = 1;
  EXPECT_EQ(length_s(random).value_or(0), 2 * (3 + 5 + 20) + 10.0);
}

TEST(TrialRun, RedoRejectAndAbort_InEachPhase) {
  RecordProperty("requirement", "SES-3");
  for (const int second : {1, 3, 10, 30, 50}) {
    const auto at = [second](int later) { return "@" + std::to_string(second + later); };
    const auto after = [&at](std::string commands) {
      TrialRun run(timed(), 1, {});
      (void)told(run, "next@0 tick" + at(0));
      for (std::size_t place = commands.find('#'); place != std::string::npos; place = commands.find('#'))
        commands.replace(place, 1, at(0));
      return told(run, commands);
    };
    EXPECT_EQ(after("redo# tick@1000 next@1000"), " redone 1.1a" + at(0) + " ready 1.2a" + at(0) + " go 1.2a" + at(2) + " measure 1.2a" +
                                                      at(7) + " done 1.2a" + at(27) + " rest 1.2a" + at(27) +
                                                      "(10s) ready 2.1b@1000 | ready 2.1b of 4 block 1, next 3a, 2 s");
    EXPECT_EQ(after("reject# !reject# !redo# next# redo#"), " rejected 1.1a" + at(0) + (second < 27 ? " rest 1.1a" + at(0) + "(10s)" : "") +
                                                                " ready 2.1b" + at(0) + " redone 2.1b" + at(0) + " ready 2.2b" + at(0) +
                                                                " | ready 2.2b of 4 block 1, next 3a, 2 s");
    EXPECT_EQ(after("abort# abort# !next# !redo# !reject# tick@1000"),
              (second < 27 ? " aborted 1.1a" + at(0) : "") + " | waiting 1.1a of 4 block 1, next 2b, 0 s");
  }
}

TEST(TrialRun, Events_HaveTheLabelsOfTheirCondition) {
  TrialRun run(timed(), 1, kArm);
  ASSERT_TRUE(run.next(0));
  const auto events = run.take_events();
  EXPECT_EQ(events[0].labels, (std::vector<std::pair<std::string, std::string>>{{"eyes", "open"}}));
  EXPECT_EQ(events[0].block, 1U);
  EXPECT_TRUE(run.take_events().empty());
}

TEST(TrialRun, ManySmallTicks_TellTheSameAsOneLate) {
  TrialRun patient(by_itself(timed()), 1, {});
  TrialRun late(by_itself(timed()), 1, {});
  ASSERT_TRUE(patient.next(0));
  ASSERT_TRUE(late.next(0));
  for (std::int64_t now_ns = 0; now_ns <= 300 * kNanosecondsPerSecond; now_ns += 7'000'003) patient.tick(now_ns);
  EXPECT_EQ(told(patient, "tick@300"), told(late, "tick@300"));
}

TEST(TrialRun, DurationBelowANanosecond_EndsAWholePlanWithoutNesting) {
  TrialPlan plan{.conditions = {{.name = "a"}}, .trials_per_block = kMostTrials, .starts_by_itself = true, .duration_s = 1e-15};
  TrialRun run(plan, 1, {});
  ASSERT_TRUE(run.next(0));
  run.tick(kNanosecondsPerSecond);
  EXPECT_TRUE(run.is_finished());
  EXPECT_EQ(run.take_events().size(), std::size_t{4} * kMostTrials + 1);
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

}  // namespace
}  // namespace dts::session
