// SPDX-License-Identifier: Apache-2.0
#include "session/sway_results.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <set>
#include <sstream>
#include <string>
#include <tuple>

#include "core/join.h"
#include "dts/wire/event_json.h"
#include "session/json_object.h"
#include "session/session_events.h"
#include "sway_signal.h"

namespace dts::session {
namespace {

using enum TrialEventKind;

core::Worker& worker() {
  static core::Worker one("analyse");
  return one;
}

std::vector<SwayTrialResult> decided_of(SwayResults& results) {
  results.wait();
  return results.take_decided();
}

posturography::Analysis expected(std::uint64_t first, std::uint64_t end) {
  posturography::CopSeries series{.rate_hz = kRateHz};
  for (std::uint64_t scan = first; scan < end; ++scan) {
    series.ml_mm.push_back(static_cast<float>(ml_at(scan)));
    series.ap_mm.push_back(static_cast<float>(ap_at(scan)));
  }
  return *posturography::analyse(series, {.preparation = posturography::kReportPreparation});
}

/// Trial `trial` from `first` to `first + 2000`, told when it happens.
void measure(SwayResults& results, std::uint32_t trial, std::uint64_t first, const std::string& condition = "eyes-open-two-feet",
             double scale = 1.0) {
  results.take(standing_step(Measure, trial, condition), 0, {first});
  for (std::uint64_t scan = first; scan < first + 2000; scan += 40) results.take(cop_block(scan, 40, 0, scale));
  results.take(standing_step(Done, trial, condition), 0, {first + 2000});
  results.take(cop_block(first + 2000, 40, 0, scale));
}

TEST(SwayResults, OfATrialAreTheAnalysisOfItsSamplesWhateverTheBlockSize) {
  for (const std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{64}, std::size_t{250}}) {
    SwayResults results(rate_100(), rate_100(), worker());
    std::uint64_t next = 0;
    const auto run_to = [&](std::uint64_t end) {
      for (; next < end; next += size) results.take(cop_block(next, size));
    };
    run_to(310);
    results.take(standing_step(Measure, 1), 0, {300});  // told a little late
    run_to(2330);
    results.take(standing_step(Done, 1), 0, {2300});
    const auto decided = decided_of(results);
    ASSERT_EQ(decided.size(), 1U) << size;
    EXPECT_EQ(decided[0].first_scan.value, 300U);
    EXPECT_EQ(decided[0].end_scan.value, 2300U);
    ASSERT_TRUE(decided[0].analysis) << decided[0].problem;
    EXPECT_EQ(decided[0].analysis->samples, 2000U);
    EXPECT_EQ(decided[0].analysis->measures, expected(300, 2300).measures) << size;
    EXPECT_EQ(decided[0].analysis->flags, expected(300, 2300).flags) << size;
    EXPECT_TRUE(decided_of(results).empty());
  }
}

TEST(SwayResults, LongAnalysis_DelaysNobody) {
  core::Worker busy("analyse");
  std::promise<void> go_on;
  const auto before = busy.run([&] { go_on.get_future().wait(); });
  SwayResults results(rate_100(), rate_100(), busy);
  measure(results, 1, 0);
  measure(results, 2, 3000);
  EXPECT_TRUE(results.is_analysing());
  EXPECT_TRUE(results.take_decided().empty());
  results.take(standing_step(Rejected, 1), 0, {6000});
  go_on.set_value();
  const auto decided = decided_of(results);
  EXPECT_FALSE(results.is_analysing());
  ASSERT_EQ(decided.size(), 2U);
  EXPECT_EQ(decided[0].trial, 1U) << "it has values although it became void while its analysis waited";
  EXPECT_EQ(decided[1].trial, 2U);
  EXPECT_EQ(decided[1].analysis->measures, expected(3000, 5000).measures);
  ASSERT_EQ(results.counting().size(), 1U);
  EXPECT_EQ(results.counting()[0].trial, 2U);
}

/// A block of segment 1, of which scan 0 is scan `origin` of the signal.
core::Block after_gap(std::uint64_t origin, std::uint64_t first, std::size_t count) {
  core::Block block = cop_block(origin + first, count, 1);
  block.first_scan = {first};
  return block;
}

using SwayAct = std::function<void(SwayResults&)>;

SwayAct standing(TrialEventKind kind, std::uint32_t trial, std::uint64_t scan, std::uint32_t segment = 0) {
  return [=](SwayResults& results) { results.take(standing_step(kind, trial), segment, {scan}); };
}
SwayAct samples(const core::Block& block) {
  return [block](SwayResults& results) { results.take(block); };
}
void end_of_session(SwayResults& results) { results.finish(); }

TEST(SwayResults, OfATrial_AreThoseOfItsLongestStretchOrSayWhyThereAreNone) {
  constexpr std::uint64_t kEnd = 1000 + CopTrace::kMostSamples + 1000;
  struct Row {
    const char* why;
    std::vector<SwayAct> acts;
    std::string decided;  ///< Trial, segment:first scan to segment:end, and the samples or the problem.
    std::vector<std::pair<std::uint64_t, std::uint64_t>> stretches{};  ///< Of the signal, whose measures the results have.
    bool counts = true;
  };
  for (const auto& [why, acts, expected_text, stretches, counts] : std::vector<Row>{
           {"the last samples have not come", {standing(Measure, 1, 0), samples(cop_block(0, 1990)), standing(Done, 1, 2000)}, ""},
           {"running values are told a little later", {standing(Measure, 1, 0), samples(cop_block(0, 2000)), standing(Done, 1, 2000)}, ""},
           {"they have",
            {standing(Measure, 1, 0), samples(cop_block(0, 2020)), standing(Done, 1, 2000)},
            "1 0:0 to 0:2000: 2000 samples, 0 missing, flags 4; ",
            {{0, 2000}}},
           {"the next follows while the first still waits",
            {standing(Measure, 1, 0), samples(cop_block(0, 1990)), standing(Done, 1, 2000), standing(Measure, 2, 2000),
             samples(cop_block(1990, 2030)), standing(Done, 2, 4000)},
            "1 0:0 to 0:2000: 2000 samples, 0 missing, flags 4; 2 0:2000 to 0:4000: 2000 samples, 0 missing, flags 4; ",
            {{0, 2000}, {2000, 4000}}},
           {"a gap of three seconds divides it",
            {standing(Measure, 1, 0), samples(cop_block(0, 500)), samples(after_gap(800, 0, 2300)), standing(Done, 1, 2200, 1)},
            "1 0:0 to 1:2200: 2200 samples, 300 missing, flags 28; ",
            {{800, 3000}}},
           {"a gap before it",
            {samples(cop_block(0, 500)), samples(after_gap(800, 0, 100)), standing(Measure, 1, 100, 1), samples(after_gap(800, 100, 2100)),
             standing(Done, 1, 2100, 1)},
            "1 1:100 to 1:2100: 2000 samples, 0 missing, flags 4; ",
            {{900, 2900}}},
           {"the session ends before its samples come",
            {samples(cop_block(0, 500)), standing(Measure, 2, 400), standing(Done, 2, 2400), end_of_session},
            "2 0:400 to 0:2400: the session ended before the last samples of the trial arrived; "},
           {"no samples: the device was silent",
            {samples(cop_block(0, 1000)), standing(Measure, 1, 1000), standing(Done, 1, 1000), end_of_session},
            "1 0:1000 to 0:1000: no samples arrived during the measurement; "},
           {"too many",
            {standing(Measure, 2, 1000), samples(cop_block(kEnd - 100, 100)), standing(Done, 2, kEnd), end_of_session},
            "2 0:1000 to 0:5002000: longer than 10 min: analyse the recording with dtslab sway; "},
           {"one sample did not come; in the recording it stands",
            {standing(Measure, 1, 0), samples(cop_block(0, 500)), samples(cop_block(501, 1600)), standing(Done, 1, 2000)},
            "1 0:0 to 0:2000: samples were dropped before the analysis: analyse the recording with dtslab sway; "},
           {"redone when all its samples had come: it has values and does not count",
            {standing(Measure, 1, 0), samples(cop_block(0, 2040)), standing(Done, 1, 2000), standing(Redone, 1, 2100)},
            "1 0:0 to 0:2000: 2000 samples, 0 missing, flags 4; ",
            {{0, 2000}},
            false},
           {"redone before its samples had come",
            {standing(Measure, 1, 0), samples(cop_block(0, 1990)), standing(Done, 1, 2000), standing(Redone, 1, 2000),
             samples(cop_block(1990, 100))},
            ""},
           {"rejected after its end, and that undone",
            {standing(Measure, 1, 0), samples(cop_block(0, 2040)), standing(Done, 1, 2000), standing(Rejected, 1, 2040),
             samples(cop_block(2040, 400)), standing(Undone, 1, 2440)},
            "1 0:0 to 0:2000: 2000 samples, 0 missing, flags 4; ",
            {{0, 2000}}},
           {"rejected while it was measured, undone when its time was over",
            {standing(Measure, 1, 0), samples(cop_block(0, 1800)), standing(Rejected, 1, 1800), samples(cop_block(1800, 490)),
             standing(Undone, 1, 2290), standing(Done, 1, 2000)},
            "1 0:0 to 0:2000: 2000 samples, 0 missing, flags 4; ",
            {{0, 2000}}},
           {"rejected while it settled: its measurement began before the undo",
            {samples(cop_block(0, 1000)), standing(Rejected, 1, 1000), samples(cop_block(1000, 490)), standing(Undone, 1, 1490),
             standing(Measure, 1, 1100), samples(cop_block(1490, 2000)), standing(Done, 1, 3100)},
            "1 0:1100 to 0:3100: 2000 samples, 0 missing, flags 4; ",
            {{1100, 3100}}},
           {"rejected, then a gap of three seconds, and undone",
            {standing(Measure, 1, 0), samples(cop_block(0, 1500)), standing(Rejected, 1, 1480), samples(after_gap(1800, 0, 100)),
             standing(Undone, 1, 100, 1), samples(after_gap(1800, 100, 2200)), standing(Done, 1, 2200, 1)},
            "1 0:0 to 1:2200: 2200 samples, 300 missing, flags 28; ",
            {{1800, 4000}}},
           {"rejected and not undone: its samples are not kept",
            {standing(Measure, 1, 0), samples(cop_block(0, 1800)), standing(Rejected, 1, 1800), samples(cop_block(1800, 2000)),
             samples(cop_block(3800, 2000)), standing(Undone, 1, 5800), standing(Done, 1, 2000)},
            "1 0:0 to 0:2000: samples were dropped before the analysis: analyse the recording with dtslab sway; "},
       }) {
    SCOPED_TRACE(why);
    SwayResults results(rate_100(), rate_100(), worker());
    for (const SwayAct& act : acts) act(results);
    std::ostringstream text;
    std::size_t analysed = 0;
    for (const SwayTrialResult& result : decided_of(results)) {
      text << result.trial << ' ' << result.segment << ':' << result.first_scan.value << " to " << result.end_segment << ':'
           << result.end_scan.value << ": " << result.problem;
      if (result.analysis) {
        text << result.analysis->samples << " samples, " << result.analysis->missing << " missing, flags " << result.analysis->flags;
        ASSERT_LT(analysed, stretches.size());
        EXPECT_EQ(result.analysis->measures, expected(stretches[analysed].first, stretches[analysed].second).measures);
        ++analysed;
      }
      text << "; ";
    }
    EXPECT_EQ(text.str(), expected_text);
    EXPECT_EQ(analysed, stretches.size());
    EXPECT_EQ(results.summary().empty(), analysed == 0 || !counts);
  }
}

TEST(SwayResults, MemoryOfAnEndlessTrialIsBounded) {
  CopTrace trace(rate_100(), rate_100());
  trace.keep_from(TracePlace{});
  core::Block block(3, 100'000);
  block.set_count(block.capacity());
  for (; block.first_scan.value < CopTrace::kMostSamples; block.first_scan.value += block.count()) trace.take(block);
  EXPECT_TRUE(trace.cut({0, {0}}, {0, {100}}));
  trace.take(block);
  EXPECT_FALSE(trace.cut({0, {0}}, {0, {100}})) << "the oldest are forgotten";
  EXPECT_TRUE(trace.cut({0, {100'000}}, {0, {200'000}}));
}

TEST(SwayResults, SamplesOfATrial_StayWhileTheTraceGoesOn) {
  CopTrace trace(rate_100(), rate_100());
  trace.keep_from(TracePlace{});
  trace.take(cop_block(0, 5000));
  const auto cut = trace.cut({0, {4090}}, {0, {4100}});  // across the end of a chunk
  ASSERT_TRUE(cut);
  trace.keep_from(std::nullopt);
  trace.take(cop_block(5000, 20'000));
  EXPECT_FALSE(trace.cut({0, {4090}}, {0, {4100}}));
  const posturography::CopSeries series = cut->series();
  ASSERT_EQ(series.ml_mm.size(), 10U);
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_EQ(series.ml_mm[i], static_cast<float>(ml_at(4090 + i)));
}

TEST(SwayResults, ASlowerCopStreamIsCutAtTheRightScans) {
  CopTrace trace(*core::Rate::create(1500, 1), rate_100());
  trace.take(cop_block(0, 400));
  const auto cut = trace.cut({0, {1500}}, {0, {4500}});
  ASSERT_TRUE(cut);
  const posturography::CopSeries series = cut->series();
  EXPECT_EQ(series.ml_mm.size(), 200U);
  EXPECT_EQ(series.ml_mm[0], static_cast<float>(ml_at(100)));
}

TEST(SwayResults, DoubtOfASampleInTheTrial_IsADoubtOfItsResult) {
  namespace quality = core::quality;
  for (const auto& [bits, axis, scan, is_doubtful] :
       std::vector<std::tuple<std::uint8_t, std::size_t, std::uint64_t, bool>>{{quality::kUntared, 0, 100, true},
                                                                               {quality::kSubstituted, 1, 299, true},
                                                                               {quality::kRail, 0, 200, false},
                                                                               {quality::kUntared, 0, 99, false},
                                                                               {quality::kUntared, 1, 300, false}}) {
    CopTrace trace(rate_100(), rate_100());
    core::Block block = cop_block(0, 400);
    block.quality(axis)[scan] = bits;
    trace.take(block);
    const auto cut = trace.cut({0, {100}}, {0, {300}});
    ASSERT_TRUE(cut);
    EXPECT_EQ(cut->series().flags, is_doubtful ? posturography::sway_flag::kDoubtful : 0U) << scan;
  }
}

double figure(const std::vector<SessionFigure>& figures, const std::string& name) {
  const auto found = std::ranges::find(figures, name, &SessionFigure::name);
  return found == figures.end() ? -1.0 : found->value;
}
std::string unit_and_details(const std::vector<SessionFigure>& figures, const std::string& name) {
  const auto found = std::ranges::find(figures, name, &SessionFigure::name);
  return found == figures.end() ? "" : found->unit + " " + found->details;
}
std::string number(double value) {
  JsonObject json;
  json.add("", value);
  return json.text().substr(4, json.text().size() - 5);
}

std::string missing(const std::vector<SwayTrialResult>& trials) {
  return core::join(missing_quotients(trials), "; ", [](const MissingQuotient& each) { return each.stance + ": " + each.reason; });
}

TEST(SwaySummary, HasMeansByConditionAndRombergQuotients) {
  RecordProperty("requirement", "SWAY-6");
  SwayResults results(rate_100(), rate_100(), worker());
  measure(results, 1, 0, "eyes-open-two-feet", 1.0);
  measure(results, 2, 2040, "eyes-closed-two-feet", 2.0);
  measure(results, 3, 4080, "eyes-open-two-feet", 3.0);
  const auto decided = decided_of(results);
  ASSERT_EQ(decided.size(), 3U);
  const auto rdist = [&](std::size_t trial) { return *decided[trial].analysis->measures.get(posturography::Measure::Rdist); };
  const auto figures = results.summary();
  const double open = (rdist(0) + rdist(2)) / 2.0;
  EXPECT_DOUBLE_EQ(figure(figures, "eyes-open-two-feet/RDIST"), open);
  EXPECT_DOUBLE_EQ(figure(figures, "eyes-closed-two-feet/RDIST"), rdist(1));
  EXPECT_DOUBLE_EQ(figure(figures, "romberg/feet=two/RDIST"), rdist(1) / open);
  const std::string of_all = R"("profile":"lp10","rate_hz":100,"duration_s":20})";
  EXPECT_EQ(unit_and_details(figures, "eyes-closed-two-feet/RDIST"), R"(mm {"trials":1,)" + of_all);
  const double sd = std::sqrt((rdist(0) - open) * (rdist(0) - open) + (rdist(2) - open) * (rdist(2) - open));
  EXPECT_EQ(unit_and_details(figures, "eyes-open-two-feet/RDIST"), R"(mm {"trials":2,"sd":)" + number(sd) + "," + of_all);
  EXPECT_EQ(unit_and_details(figures, "romberg/feet=two/RDIST"),
            R"(1 {"open":)" + number(open) + R"(,"closed":)" + number(rdist(1)) + R"(,"open_trials":2,"closed_trials":1,"duration_s":20})");
}

TEST(SwaySummary, NoQuotientOfTrialsOfDifferentLengthStanceOrEyesAlone) {
  RecordProperty("requirement", "SWAY-6");
  SwayResults results(rate_100(), rate_100(), worker());
  measure(results, 1, 0, "eyes-open-two-feet");
  results.take(standing_step(Measure, 2, "eyes-closed-two-feet"), 0, {2040});
  results.take(cop_block(2040, 3020));
  results.take(standing_step(Done, 2, "eyes-closed-two-feet"), 0, {5040});
  auto trials = decided_of(results);
  ASSERT_EQ(trials.size(), 2U);
  const auto has_quotient = [](const std::vector<SwayTrialResult>& of) {
    const auto figures = sway_summary(of);
    return std::ranges::any_of(figures, [](const SessionFigure& each) { return each.name.starts_with("romberg/"); });
  };
  EXPECT_FALSE(has_quotient(trials));  // 20 s against 30 s
  EXPECT_EQ(missing(trials), "feet=two: the trials with eyes open last 20 s, those with eyes closed 30 s");
  trials[1].analysis->duration_s = trials[0].analysis->duration_s - 0.09;
  EXPECT_TRUE(has_quotient(trials));
  trials[1].analysis->duration_s -= 0.02;
  EXPECT_FALSE(has_quotient(trials));
  trials[1].analysis->duration_s = trials[0].analysis->duration_s;
  trials[0].analysis->measures.set(posturography::Measure::Rdist, 0.0);
  EXPECT_TRUE(has_quotient(trials));
  EXPECT_EQ(figure(sway_summary(trials), "romberg/feet=two/RDIST"), -1.0);
  EXPECT_EQ(missing(trials), "");
  trials[1].labels[1].second = "one";
  EXPECT_FALSE(has_quotient(trials));
  EXPECT_EQ(missing(trials), "") << "no stance has both";
  trials[1].labels[1].second = "two";
  trials[1].analysis.reset();
  EXPECT_EQ(missing(trials), "feet=two: no trial with eyes closed counts");
}

TEST(SwaySummary, NoQuotientOfConditionsThatAreTwiceThere) {
  SwayResults results(rate_100(), rate_100(), worker());
  measure(results, 1, 0, "eyes-open-before", 1.0);
  measure(results, 2, 2040, "eyes-closed", 2.0);
  measure(results, 3, 4080, "eyes-open-after", 3.0);
  auto trials = decided_of(results);
  ASSERT_EQ(trials.size(), 3U);
  std::set<std::string> names;
  for (const SessionFigure& each : sway_summary(trials)) {
    EXPECT_TRUE(names.insert(each.name).second) << each.name << " twice";
    EXPECT_FALSE(each.name.starts_with("romberg/")) << each.name << ": of which of the two?";
  }
  EXPECT_EQ(missing(trials), "feet=two: there are several conditions with eyes open");
  trials.pop_back();
  EXPECT_GT(figure(sway_summary(trials), "romberg/feet=two/RDIST"), 0.0);
}

TEST(SwaySummary, QuotientAndMeans_AreOfTrialsWithoutFeedbackOnly) {
  SwayResults results(rate_100(), rate_100(), worker());
  measure(results, 1, 0, "eyes-open", 1.0);
  measure(results, 2, 2040, "eyes-open-feedback", 3.0);
  measure(results, 3, 4080, "eyes-closed", 2.0);
  auto trials = decided_of(results);
  ASSERT_EQ(trials.size(), 3U);
  trials[1].labels.emplace_back("feedback", "cop");
  const auto rdist = [&](std::size_t trial) { return *trials[trial].analysis->measures.get(posturography::Measure::Rdist); };
  const auto figures = sway_summary(trials);
  EXPECT_DOUBLE_EQ(figure(figures, "eyes-open/RDIST"), rdist(0));
  EXPECT_DOUBLE_EQ(figure(figures, "eyes-open-feedback/RDIST"), rdist(1));
  EXPECT_DOUBLE_EQ(figure(figures, "romberg/feet=two/RDIST"), rdist(2) / rdist(0));
  for (const SessionFigure& each : figures) EXPECT_EQ(each.name.find("romberg/feedback"), std::string::npos) << each.name;
  trials.erase(trials.begin());
  for (const SessionFigure& each : sway_summary(trials))
    EXPECT_FALSE(each.name.starts_with("romberg/")) << "only with feedback: " << each.name;
  EXPECT_EQ(missing(trials), "") << "no stance has both";
}

TEST(SwaySummary, LeavesInvalidTrialsOut) {
  SwayResults results(rate_100(), rate_100(), worker());
  measure(results, 1, 0);
  auto trials = decided_of(results);
  trials[0].analysis->flags |= posturography::sway_flag::kSteppedOff;
  EXPECT_TRUE(sway_summary(trials).empty());
}

TEST(SwaySummary, LeavesTrialsThatAGapHasCutOut_UnlessNoneIsWhole) {
  SwayResults results(rate_100(), rate_100(), worker());
  measure(results, 1, 0, "eyes-open-two-feet", 1.0);
  measure(results, 2, 2040, "eyes-open-two-feet", 3.0);
  auto trials = decided_of(results);
  ASSERT_EQ(trials.size(), 2U);
  const auto rdist = [&](std::size_t trial) { return *trials[trial].analysis->measures.get(posturography::Measure::Rdist); };
  trials[1].analysis->flags |= posturography::sway_flag::kCutAtGap;
  EXPECT_DOUBLE_EQ(figure(sway_summary(trials), "eyes-open-two-feet/RDIST"), rdist(0));
  trials[0].analysis->flags |= posturography::sway_flag::kCutAtGap;
  EXPECT_DOUBLE_EQ(figure(sway_summary(trials), "eyes-open-two-feet/RDIST"), (rdist(0) + rdist(1)) / 2.0);
}

TEST(SwayRecord, ReadsBackAsItWasWritten) {
  SwayResults results(rate_100(), rate_100(), worker());
  measure(results, 7, 0);
  const SwayTrialResult result = decided_of(results).at(0);
  const std::string json = wire::to_json(to_event(result, "s1", "dtsd 1.2.3"));
  const auto event = wire::event_of_json(json);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->sway().software(), "dtsd 1.2.3");
  const auto back = sway_of(*event);
  ASSERT_TRUE(back) << back.error().what;
  EXPECT_EQ(back->trial, 7U);
  EXPECT_EQ(back->labels, result.labels);
  EXPECT_EQ(back->end_scan, result.end_scan);
  EXPECT_EQ(back->analysis->measures, result.analysis->measures);  // to the bit
  EXPECT_EQ(back->analysis->flags, result.analysis->flags);
}

}  // namespace
}  // namespace dts::session
