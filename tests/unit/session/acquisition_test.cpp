// SPDX-License-Identifier: Apache-2.0
#include "session/acquisition.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/utf8.h"
#include "scripted_device.h"

namespace dts::session {
namespace {

using device::ReadOutcome;

/// An acquisition at 100 Hz over a script, in virtual time, that the test runs itself.
struct Live : ScanSink {
  explicit Live(std::deque<ScriptedDevice::Step> script) : device(std::move(script)) {}
  static constexpr std::size_t kBlock = 8;
  core::VirtualClock clock;
  ScriptedDevice device;
  Acquisition acquisition{device, clock, *this, core::Rate::create(100, 1).value(), kBlock};
  std::string blocks;  ///< "segment:first scan+count" of all blocks, the gap before each, and all scans lost until then.

  void process(const core::Acquired& acquired, bool /*has_more*/) noexcept override {
    const auto& [reason, missing, is_exact] = acquired.gap_before;
    std::ostringstream text;
    if (reason != core::GapReason::None) text << core::name(reason) << (is_exact ? " of " : " of about ") << missing << ", ";
    text << acquired.block.segment << ':' << acquired.block.first_scan.value << '+' << acquired.block.count();
    if (acquired.lost_scans_total != 0) text << " (" << acquired.lost_scans_total << " lost)";
    blocks += (blocks.empty() ? "" : "; ") + text.str();
  }
};

std::string totals_of(const AcquisitionReport& report, const ScriptedDevice& device) {
  std::ostringstream text;
  text << report.scans_total << " scans, " << report.losses.total().gaps << " gaps of " << report.losses.total().scans << ", "
       << report.reconnects_total << " reconnects, " << report.restarts_total << " restarts, " << device.opens << " opens, "
       << device.starts << " starts";
  return text.str();
}

/// Runs an acquisition over a script on the calling thread and keeps its last report.
struct Playback : Live {
  explicit Playback(std::deque<ScriptedDevice::Step> script, int failing_opens = 0) : Live(std::move(script)) {
    device.failing_opens = failing_opens;
    device.on_end = [&] { acquisition.request_stop(); };
    acquisition.run();
    report = acquisition.report();
  }
  AcquisitionReport report;
};

TEST(Acquisition, Gaps_AreToldOnceWithTheirLengthAndStartASegmentAtZero) {
  RecordProperty("requirement", "ACQ-4");
  const auto gap = [](core::GapReason reason, std::uint64_t missing, bool is_exact) {
    return ScriptedDevice::Step{.outcome = ReadOutcome::Gap, .gap = {.reason = reason, .missing_scans = missing, .is_exact = is_exact}};
  };
  const auto overrun = gap(core::GapReason::Overrun, 5, true);
  const ScriptedDevice::Step gone{.outcome = ReadOutcome::Gone};
  const auto after = [](std::int64_t periods) { return ScriptedDevice::Step{.scans = 1, .pause_ns = periods * ScriptedDevice::kPeriodNs}; };
  for (const auto& [why, script, expected] : std::vector<std::tuple<const char*, std::deque<ScriptedDevice::Step>, const char*>>{
           {"unbroken",
            {{.scans = 2}, {.scans = 8}, {.scans = 1}},
            "0:0+2; 0:2+8; 0:10+1 | 11 scans, 0 gaps of 0, 0 reconnects, 0 restarts, 1 opens, 1 starts"},
           {"of the device",
            {{.scans = 3}, overrun, {.scans = 2}, {.scans = 2}},
            "0:0+3; overrun of 5, 1:0+2 (5 lost); 1:2+2 (5 lost) | 7 scans, 1 gaps of 5, 0 reconnects, 0 restarts, 1 opens, 1 starts"},
           {"unplugged: estimated from host time",
            {{.scans = 1}, gone, after(40)},
            "0:0+1; unplugged of about 40, 1:0+1 (40 lost) | 2 scans, 1 gaps of 40, 1 reconnects, 0 restarts, 2 opens, 2 starts"},
           {"counter jumps without notice",
            {{.scans = 2}, {.scans = 2, .skip_index = 3}},
            "0:0+2; integrity of about 3, 1:0+2 (3 lost) | 4 scans, 1 gaps of 3, 0 reconnects, 0 restarts, 1 opens, 1 starts"},
           {"two in a row become one longer",
            {{.scans = 1}, overrun, gap(core::GapReason::Silence, 7, false), {.scans = 1}},
            "0:0+1; overrun of about 12, 1:0+1 (12 lost) | 2 scans, 1 gaps of 12, 0 reconnects, 0 restarts, 1 opens, 1 starts"},
           {"unknown after a counted one: the time between the scans",
            {{.scans = 1}, overrun, gone, after(600)},
            "0:0+1; overrun of about 600, 1:0+1 (600 lost) | 2 scans, 1 gaps of 600, 1 reconnects, 0 restarts, 2 opens, 2 starts"},
           {"counted, and the time between the scans is a little longer",
            {{.scans = 1}, gap(core::GapReason::Overrun, 500, true), after(600)},
            "0:0+1; overrun of 500, 1:0+1 (500 lost) | 2 scans, 1 gaps of 500, 0 reconnects, 0 restarts, 1 opens, 1 starts"},
           {"counted by 16 bits that have turned over: the time between the scans",
            {{.scans = 1}, overrun, after(65'541)},
            "0:0+1; overrun of about 65541, 1:0+1 (65541 lost) | 2 scans, 1 gaps of 65541, 0 reconnects, 0 restarts, 1 opens, 1 starts"},
           {"host time jumps by a second",
            {{.scans = 1}, after(100)},
            "0:0+1; 0:1+1 | 2 scans, 0 gaps of 0, 0 reconnects, 0 restarts, 1 opens, 1 starts"},
           {"by more",
            {{.scans = 2}, after(500)},
            "0:0+2; silence of about 500, 1:0+1 (500 lost) | 3 scans, 1 gaps of 500, 0 reconnects, 0 restarts, 1 opens, 1 starts"},
       }) {
    const Playback run(script);
    EXPECT_EQ(run.blocks + " | " + totals_of(run.report, run.device), expected) << why;
  }
}

TEST(Acquisition, DeviceThatKnowsWhyItIsGone_IsQuoted) {
  Live run({{.outcome = ReadOutcome::Gone}});
  run.device.reason = "the program x ended with exit status 3";
  std::string message;
  run.device.on_arrival_question = [&] {
    message = run.acquisition.report().text();
    return true;
  };
  run.device.on_end = [&] { run.acquisition.request_stop(); };
  run.acquisition.run();
  EXPECT_EQ(message, "the program x ended with exit status 3; dtsd opens it again by itself");
}

TEST(Acquisition, DeviceThatIsBackAtOnce_TheGapKeepsWhyItWasGone_TheNextGapDoesNot) {
  Live run({{.scans = 1}, {.outcome = ReadOutcome::Gone}, {.scans = 1}});
  run.device.reason = "the program x ended with exit status 3";
  std::string first;
  run.device.on_end = [&] {
    if (!first.empty()) return run.acquisition.request_stop();
    first = run.acquisition.report().gap_text();
    if (first.empty()) return run.acquisition.request_stop();
    run.device.extend({{.outcome = ReadOutcome::Gap, .gap = {.reason = core::GapReason::Overrun, .missing_scans = 1}}, {.scans = 1}});
  };
  run.acquisition.run();
  EXPECT_EQ(first, "the program x ended with exit status 3");
  EXPECT_EQ(run.acquisition.report().last_gap.reason, core::GapReason::Overrun);
  EXPECT_EQ(run.acquisition.report().gap_text(), "");
}

TEST(Acquisition, DeviceGoneAgainBeforeItsFirstScan_TheGapKeepsTheFirstReason) {
  const ScriptedDevice::Step gone{.outcome = ReadOutcome::Gone};
  Live run({{.scans = 1}, gone, gone, gone, {.scans = 1}});  // the first retry is at once
  run.device.reason = "the program x ended with exit status 3";
  run.device.on_arrival_question = [&] {
    run.device.reason = "the program x cannot start";
    return true;
  };
  run.device.on_end = [&] { run.acquisition.request_stop(); };
  run.acquisition.run();
  EXPECT_EQ(run.acquisition.report().losses.total().gaps, 1U);
  EXPECT_EQ(run.acquisition.report().gap_text(), "the program x ended with exit status 3");
}

TEST(Acquisition, DeviceAbsentAtStart_IsTriedAgainAndIsNoGap) {
  const Playback run({{.scans = 1}}, 3);

  EXPECT_EQ(run.blocks, "0:0+1");
  EXPECT_EQ(totals_of(run.report, run.device), "1 scans, 0 gaps of 0, 0 reconnects, 0 restarts, 4 opens, 1 starts");
}

TEST(Acquisition, DeviceGoneAtEveryFirstRead_IsRetriedWithGrowingPauses) {
  const Playback run(std::deque<ScriptedDevice::Step>(5, {.outcome = ReadOutcome::Gone}));

  // 0.25, 0.5, 1, 2, 4 s: as fast as it computes would be none of them.
  EXPECT_EQ(run.clock.now_ns(), 7'750'000'000);
  EXPECT_EQ(run.report.losses.total().gaps, 0U);
}

TEST(Acquisition, StreamThatBreaksAfterSeconds_IsStartedAgainAtOnceInANewSegment) {
  const core::Gap doubt{.reason = core::GapReason::Integrity};
  std::deque<ScriptedDevice::Step> script(130, {.scans = 8});
  script.push_back({.outcome = ReadOutcome::Broken, .gap = doubt});
  script.push_back({.scans = 2, .pause_ns = 30 * ScriptedDevice::kPeriodNs});
  const Playback run(script);

  EXPECT_EQ(run.blocks.substr(run.blocks.rfind("; ")), "; integrity of about 30, 1:0+2 (30 lost)");
  EXPECT_EQ(totals_of(run.report, run.device), "1042 scans, 1 gaps of 30, 0 reconnects, 1 restarts, 2 opens, 2 starts");
  EXPECT_EQ(run.clock.now_ns(), 0) << "a stream that ran before is started again without a pause";
}

TEST(Acquisition, StreamThatBreaksSecondsAfterItsReturn_IsStartedAgainAtOnce) {
  std::deque<ScriptedDevice::Step> script{{.scans = 8}, {.outcome = ReadOutcome::Gone}};
  script.insert(script.end(), 4, {.outcome = ReadOutcome::Gone});  // the pauses have grown meanwhile
  script.insert(script.end(), 38, {.scans = 8});                   // 3 s
  script.push_back({.outcome = ReadOutcome::Broken, .gap = {.reason = core::GapReason::Stall}});
  script.push_back({.scans = 8});
  const Playback run(script);

  EXPECT_EQ(run.clock.now_ns(), 3'750'000'000) << "0.25 + 0.5 + 1 + 2 s while it was away, and nothing after the stall";
  EXPECT_EQ(run.blocks.substr(run.blocks.rfind("; ")), "; stall of about 0, 2:0+8");
}

TEST(Acquisition, StreamThatBreaksRightAfterItsReturn_IsStartedAgainAtOnce) {
  std::deque<ScriptedDevice::Step> script(130, {.scans = 8});
  script.insert(script.end(), 5, {.outcome = ReadOutcome::Gone});  // the pauses have grown meanwhile
  script.push_back({.scans = 8});                                  // 80 ms
  script.push_back({.outcome = ReadOutcome::Broken, .gap = {.reason = core::GapReason::Stall}});
  script.push_back({.scans = 8});
  script.push_back({.outcome = ReadOutcome::Broken});
  script.push_back({.scans = 8});
  const Playback run(script);

  EXPECT_EQ(run.clock.now_ns(), 3'750'000'000 + 250'000'000) << "while it was away; nothing after the first break, then gently";
}

TEST(Acquisition, DeviceLostAfterEachLongStream_IsOpenedAgainAtOnceEachTime) {
  std::deque<ScriptedDevice::Step> script;
  for (int loss = 0; loss < 3; ++loss) {
    script.insert(script.end(), 130, {.scans = 8});
    script.push_back({.outcome = ReadOutcome::Gone});
  }
  script.push_back({.scans = 8});
  const Playback run(script);

  EXPECT_EQ(run.clock.now_ns(), 0);
  EXPECT_EQ(run.report.reconnects_total, 3U);
}

TEST(Acquisition, FirstBreakOfAll_IsStartedAgainAtOnce) {
  const Playback run({{.scans = 8}, {.outcome = ReadOutcome::Broken}, {.scans = 8}});

  EXPECT_EQ(run.clock.now_ns(), 0);
  EXPECT_EQ(run.report.restarts_total, 1U);
}

TEST(Acquisition, StreamThatBreaksAgainAndAgain_IsRetriedWithGrowingPauses) {
  std::deque<ScriptedDevice::Step> script;
  for (int i = 0; i < 6; ++i) {
    script.push_back({.scans = 8});
    script.push_back({.outcome = ReadOutcome::Broken});
  }
  const Playback run(script);

  EXPECT_EQ(run.clock.now_ns(), 7'750'000'000);
  EXPECT_EQ(run.report.losses.total().gaps, 5U);
}

TEST(Acquisition, SuspendedMachine_TheTimeAsleepIsInTheGap) {
  std::deque<ScriptedDevice::Step> script(1, {.scans = 1});
  script.push_back({.outcome = ReadOutcome::Gone});
  Live live(script);
  bool has_slept = false;
  live.device.on_end = [&] {
    if (std::exchange(has_slept, true)) return live.acquisition.request_stop();
    live.clock.suspend_ns(3600'000'000'000);
    live.device.extend({{.scans = 1, .pause_ns = 40 * ScriptedDevice::kPeriodNs}});
  };

  live.acquisition.run();

  EXPECT_EQ(live.blocks, "0:0+1; unplugged of about 360040, 1:0+1 (360040 lost)");
}

TEST(Acquisition, ArmedDevice_IsWaitingAndNotSilent) {
  Live live(std::deque<ScriptedDevice::Step>(3, {.outcome = ReadOutcome::Armed}));
  AcquisitionReport armed;
  bool has_fired = false;
  live.device.on_end = [&] {
    if (std::exchange(has_fired, true)) return live.acquisition.request_stop();
    armed = live.acquisition.report();
    live.device.extend({{.scans = 1}});
  };

  live.acquisition.run();

  EXPECT_TRUE(armed.is_armed);
  EXPECT_FALSE(armed.is_silent);
  EXPECT_EQ(armed.text(), "waiting for the external trigger");
  EXPECT_FALSE(live.acquisition.report().is_armed);
  EXPECT_EQ(live.acquisition.report().text(), "");
}

/// The report when reads in which nothing came each took so long, one after the other.
std::string report_after_reads_that_took(std::int64_t read_ns, int reads) {
  Live live(std::deque<ScriptedDevice::Step>(1, {.scans = 1}));
  std::string reported;
  live.device.on_end = [&] {
    reported = live.acquisition.report().text();
    if (reads-- == 0) live.acquisition.request_stop();
    live.clock.advance_ns(read_ns);
  };
  live.acquisition.run();
  return reported;
}

TEST(Acquisition, DeviceThatDeliversNothing_IsToldAfterASecond) {
  RecordProperty("requirement", "ACQ-13");
  EXPECT_EQ(report_after_reads_that_took(200'000'000, 8), "device is connected but delivers no scans; check its cable and power");
}

TEST(Acquisition, ProcessThatStoodStill_IsNoNewsOfTheDevice) { EXPECT_EQ(report_after_reads_that_took(5'000'000'000, 1), ""); }

TEST(Acquisition, UnitThatIsPluggedIn_EndsThePauseBeforeTheNextTry) {
  Live live(std::deque<ScriptedDevice::Step>(1, {.scans = 1}));
  live.device.failing_opens = 5;
  live.device.on_arrival_question = [&] { return live.device.opens == 5; };
  live.device.on_end = [&] { live.acquisition.request_stop(); };

  live.acquisition.run();

  EXPECT_EQ(live.device.opens, 6);
  EXPECT_EQ(live.clock.now_ns(), 3'800'000'000) << "0.25 + 0.5 + 1 + 2 s, and not 4 s more";
}

TEST(Acquisition, DeviceThatRunsAtAnotherRateThanItPromised_IsNotBelieved) {
  RecordProperty("requirement", "ACQ-8");
  Live live(std::deque<ScriptedDevice::Step>(1, {.scans = 1}));
  live.device.starts_at_rate_factor = 1.01;
  live.device.on_arrival_question = [&] {
    live.acquisition.request_stop();
    return false;
  };

  live.acquisition.run();

  EXPECT_EQ(live.blocks, "");
  EXPECT_EQ(std::string(live.acquisition.report().text()), " runs at 101.000000 Hz, but promised 100.000000 Hz");
}

TEST(AcquisitionReport, LongMessage_IsCutNotOverrun) {
  AcquisitionReport report;

  report.set_message(std::string(1000, 'x'));

  EXPECT_EQ(report.text().size(), 511U);
}

TEST(AcquisitionReport, LongMessage_IsNotCutInsideACharacter) {
  std::string text;
  for (int i = 0; i < 300; ++i) text += "\u00e9\u20ac\U0001F600";  // 2, 3 and 4 bytes
  for (std::size_t before = 0; before < 9; ++before) {
    AcquisitionReport report;
    report.set_message(std::string(before, 'x') + text);
    EXPECT_TRUE(core::is_utf8(report.text())) << before;
    EXPECT_GE(report.text().size(), 508U);
  }
}

}  // namespace
}  // namespace dts::session
