// SPDX-License-Identifier: Apache-2.0
#include "session/corrected_results.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "dts/wire/event_json.h"
#include "reach_results_events.h"
#include "record/xdf/xdf_writer.h"
#include "session/session_events.h"
#include "support/committed_text.h"

namespace dts::session {
namespace {

using core::TrunkClass;
using made::tell_trial;

class CorrectedResultsTest : public ::testing::Test {
 protected:
  CorrectedResultsTest() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-corrected-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~CorrectedResultsTest() override { std::filesystem::remove_all(folder_); }

  /// A session on the chair as the catalogue has it, from what a judge found.
  record::SessionRow session_of(const ReachResults& results) {
    record::SessionFacts facts{.session_id = "s1", .rig = "chair", .protocol = "reaching"};
    facts.fields = {{"weight_kg", "68"}, {"height_cm", "175"}, {"arm_length_cm", "67"}, {"max_reach_cm", "124"}};
    const std::string file = (folder_ / "s1.xdf").string();
    auto writer = record::XdfWriter::create(file, record::to_facts(facts));
    EXPECT_TRUE(writer && (*writer)->close());
    record::SessionRow session{.id = "s1", .rig = "chair"};
    session.parts = {{.session_id = "s1", .part = 1, .file = file, .leading_part = 1}};
    for (const ReachTrialResult& result : results.results()) {
      session.trials.push_back({.session_id = "s1",
                                .trial = result.trial,
                                .condition = result.condition,
                                .outcome = "done",
                                .segment = result.segment,
                                .first_scan = result.go.value,
                                .last_segment = result.segment + (result.has_gap ? 1 : 0),
                                .result = wire::to_json(to_event(result, "s1"))});
    }
    return session;
  }
  std::filesystem::path folder_;
};

TEST_F(CorrectedResultsTest, Reaches_GiveTheFiguresOfTheirJudge_AndFewerWhenOneIsRejected) {
  ReachResults results(made::volunteer(), nullptr);
  tell_trial(results, 1, 1000, "100", 67.0, 0.125, TrunkClass::None, 1.0);
  tell_trial(results, 2, 2000, "120", 80.4, 0.25, TrunkClass::Minor, 4.0);
  tell_trial(results, 3, 3000, "150", 100.5, 0.75, TrunkClass::Rejected, 24.0);
  tell_trial(results, 4, 4000, "100", 67.0, 0.375, TrunkClass::Minor, 3.0);
  results.take(made::step(TrialEventKind::Go, 5, 1, "100", 67.0), 0, {5000});  // nothing is found here, and scans are missing
  results.take(made::step(TrialEventKind::Done, 5, 1, "100", 67.0), 1, {300});
  results.advance(1, {310});
  record::SessionRow session = session_of(results);
  ASSERT_EQ(session.trials.size(), 5U);

  const auto same = corrected_results(session);
  ASSERT_TRUE(same) << same.error().what;
  const auto figures = results.summary();
  ASSERT_EQ(same->size(), figures.size());
  for (std::size_t index = 0; index < figures.size(); ++index) {
    EXPECT_EQ((*same)[index].name, figures[index].name);
    EXPECT_EQ((*same)[index].value, figures[index].value) << figures[index].name;
    EXPECT_EQ((*same)[index].details, figures[index].details) << figures[index].name;
  }

  session.trials[1].outcome = "rejected";
  const auto fewer = corrected_results(session);
  ASSERT_TRUE(fewer);
  EXPECT_EQ(std::ranges::find(*fewer, "trials", &record::ResultRow::name)->value, 4.0);
}

TEST_F(CorrectedResultsTest, ReachesOfDtsd01_GiveTheRecordedFigures) {
  RecordProperty("requirement", "REC-9");
  const std::string file = test::committed_file("unit/record/recordings_0_1/reaching.xdf");
  const auto content = record::read_recording(file);
  ASSERT_TRUE(content) << content.error().what;
  record::SessionRow session{.id = "old", .rig = "chair"};
  session.parts = {{.session_id = "old", .part = 1, .file = file, .leading_part = 1}};
  session.trials = content->trials;
  for (record::TrialRow& trial : session.trials) trial.part = 1;

  const auto same = corrected_results(session);
  ASSERT_TRUE(same) << same.error().what;
  ASSERT_FALSE(content->results.empty());
  for (const record::ResultRow& recorded : content->results) {
    const auto found = std::ranges::find(*same, recorded.name, &record::ResultRow::name);
    ASSERT_NE(found, same->end()) << recorded.name;
    EXPECT_NEAR(found->value, recorded.value, 1e-12) << recorded.name;
  }
  EXPECT_EQ(same->size(), content->results.size());

  session.trials[3].outcome = "rejected";
  const auto fewer = corrected_results(session);
  ASSERT_TRUE(fewer) << fewer.error().what;
  EXPECT_EQ(std::ranges::find(*fewer, "trials", &record::ResultRow::name)->value, 3.0);
  EXPECT_NE(std::ranges::find(*fewer, "sparc_mean", &record::ResultRow::name), fewer->end()) << "its reaches are read from the recording";
  session.trials[0].attempt = 7;
  EXPECT_EQ(corrected_results(session).error().code, core::ErrorCode::DataDamaged) << "such a reach was not recorded";
}

TEST_F(CorrectedResultsTest, TheLoad_IsThatOfTheTrialsThatStillCount) {
  RecordProperty("requirement", "COP-13");
  record::SessionRow session = session_of(ReachResults(made::volunteer(), nullptr));  // of 68 kg
  for (const std::uint32_t trial : {1U, 2U}) {
    SwayTrialResult result{.trial = trial, .condition = "eyes-open", .labels = {{"feet", "two"}}, .analysis = posturography::Analysis{}};
    result.analysis->rate_hz = 100.0;
    result.analysis->samples = 3000;
    result.analysis->duration_s = 30.0;
    result.mean_load_n = 500.0 + 100.0 * trial;
    session.trials.push_back({.session_id = "s1",
                              .trial = trial,
                              .condition = "eyes-open",
                              .outcome = "done",
                              .result = wire::to_json(to_event(result, "s1", "dtsd"))});
  }
  const auto load_of = [&session] {
    const auto results = corrected_results(session).value();
    const auto found = std::ranges::find(results, "load_n", &record::ResultRow::name);
    return found == results.end() ? record::ResultRow{} : *found;
  };
  EXPECT_DOUBLE_EQ(load_of().value, 650.0);
  EXPECT_NE(load_of().details.find("about 66 kg"), std::string::npos) << load_of().details;
  session.trials[0].outcome = "rejected";
  EXPECT_DOUBLE_EQ(load_of().value, 700.0);
  std::filesystem::remove(session.parts[0].file);
  EXPECT_EQ(load_of().name, "") << "without the stance width nothing is said";
  session.trials[1].outcome = "rejected";
  EXPECT_EQ(load_of().name, "");
}

TEST_F(CorrectedResultsTest, ADamagedResult_IsAnError_AndAPartHasItsOwnNames) {
  ReachResults results(made::volunteer(), nullptr);
  tell_trial(results, 1, 1000, "100", 67.0, 0.125, TrunkClass::None, 1.0);
  record::SessionRow session = session_of(results);
  session.parts[0].part = session.parts[0].leading_part = session.trials[0].part = 2;
  EXPECT_EQ(corrected_results(session).value().at(0).name, "trials_part_2");
  EXPECT_TRUE(has_trial_results(session));
  std::filesystem::remove(session.parts[0].file);
  EXPECT_FALSE(corrected_results(session)) << "the measures of the volunteer are in the file";
  session.trials[0].result = "{damaged";
  EXPECT_EQ(corrected_results(session).error().code, core::ErrorCode::DataDamaged);
  session.trials[0].result.clear();
  EXPECT_TRUE(corrected_results(session)->empty());
  EXPECT_FALSE(has_trial_results(session));
}

}  // namespace
}  // namespace dts::session
