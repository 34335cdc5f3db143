// SPDX-License-Identifier: Apache-2.0
// The report of a session of the reaching task, from a made recording.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <pugixml.hpp>
#include <utility>

#include "made_reaching.h"
#include "report/chair_data.h"
#include "report/chair_tables.h"
#include "report/chair_words.h"
#include "report/intended_use.h"
#include "report/page_parts.h"
#include "report/report.h"
#include "unit/record/xdf_fixture.h"

namespace dts::report {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class ChairReportTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string write(const MadeReaching& made, const std::string& name = "a.xdf") {
    return write_reaching(directory_ / name, made);
  }
  static bool always(double) { return true; }
  [[nodiscard]] static Report report_of(const std::string& file) {
    auto report = make_report({.files = {file}, .software = "test 1"}, always);
    EXPECT_TRUE(report.has_value()) << (report ? "" : core::to_string(report.error()));
    return report.value_or(Report{});
  }
  [[nodiscard]] static std::string page(const Report& report, const std::string& file) {
    for (const Page& each : report.pages) {
      if (each.file == file) return each.text;
    }
    ADD_FAILURE() << "no page " << file;
    return {};
  }
  /// Returns the cells of the row of an HTML page whose first cell is `first`.
  [[nodiscard]] static std::vector<std::string> row(const std::string& html, const std::string& title, const std::string& first) {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_string(html.c_str(), pugi::parse_default | pugi::parse_doctype));
    const auto found = document.select_node(("//div[h2='" + title + "']//tr[normalize-space(td[1])='" + first + "']").c_str());
    std::vector<std::string> cells;
    for (const pugi::xml_node cell : found.node().children("td")) {
      const pugi::xml_node link = cell.child("a");
      cells.emplace_back(link ? link.text().get() : cell.text().get());
    }
    return cells;
  }
  static MadeReaching three_reaches() {
    MadeReaching made;
    made.reaches = {{.trial = 1}, {.trial = 2, .condition = "max", .target_cm = 124.0, .rise_mm = 2.2}, {.trial = 3, .rise_mm = 1.4}};
    made.reaches[1].movement = {.trunk_class = core::TrunkClass::Maximum,
                                .probability = {0.0, 0.02, 0.98},
                                .trunk_deg = 52.5,
                                .trunk_lo_deg = 44.3,
                                .trunk_hi_deg = 60.8};
    made.reaches[2].movement.trunk_deg = 27.0;
    return made;
  }

  record::xdf_test::Folder directory_;
};

TEST_F(ChairReportTest, OfReaches_IsAPageForEachAndOneForTheSession) {
  const Report report = report_of(write(three_reaches()));

  std::vector<std::string> files;
  for (const Page& each : report.pages) files.push_back(each.file);
  EXPECT_THAT(files, ElementsAre("session.html", "session.svg", "trial-01.html", "trial-01.svg", "trial-02.html", "trial-02.svg",
                                 "trial-03.html", "trial-03.svg"));
  EXPECT_EQ(report.session_id, "20261121T144525Z-chair-1");
  for (const Page& each : report.pages) {
    pugi::xml_document document;
    EXPECT_TRUE(document.load_string(each.text.c_str(), pugi::parse_default | pugi::parse_doctype)) << each.file;
    EXPECT_EQ(each.text.find("nan"), std::string::npos) << each.file;
    EXPECT_NE(each.text.substr(0, 1024).find(kPageMark), std::string::npos) << each.file;
  }
}

TEST_F(ChairReportTest, EveryPage_SaysWhatItIsFor) {
  RecordProperty("requirement", "REP-11");
  for (const Page& each : report_of(write(three_reaches())).pages)
    EXPECT_THAT(each.text, HasSubstr(std::string(kIntendedUse))) << each.file;
}

TEST_F(ChairReportTest, TheSameRecording_GivesTheSameBytes) {
  const std::string file = write(three_reaches());
  const std::string elsewhere = directory_ / "folder";
  std::filesystem::create_directory(elsewhere);
  std::filesystem::copy_file(file, elsewhere + "/a.xdf");
  std::filesystem::copy_file(file + ".idx", elsewhere + "/a.xdf.idx");

  const Report first = report_of(file);
  const Report second = report_of(elsewhere + "/a.xdf");

  ASSERT_EQ(first.pages.size(), second.pages.size());
  for (std::size_t index = 0; index < first.pages.size(); ++index) EXPECT_EQ(first.pages[index].text, second.pages[index].text);
}

TEST_F(ChairReportTest, RowOfATrial_HasClassAngleIntervalAndFeatures) {
  RecordProperty("requirement", "REP-8");
  const std::string html = page(report_of(write(three_reaches())), "session.html");

  EXPECT_THAT(row(html, "Trials", "2"),
              ElementsAre("2", "max", "124.0", "done", "maximum", "maximum", "52.5", "44.3 to 60.8", "0.30", "2.20", "0.80", "-1.90"));
  EXPECT_THAT(row(html, "Trunk class by target, trials that are done", "150"), ElementsAre("150", "100.5", "2", "moderate 2", "2 of 2"));
  // Mean of 25 and 27 degrees, and their standard deviation of 1.41; of 1.2 and 1.4 mm.
  EXPECT_THAT(row(html, "Consistency by target: mean (standard deviation)", "150"),
              ElementsAre("150", "26.0 (1.4)", "1.30 (0.14)", "-", "-1.90 (0.00)"));
  EXPECT_THAT(html, HasSubstr("Live and recomputed values match in 3 trials."));
  EXPECT_THAT(html, Not(HasSubstr("Rejected reaches")));
  EXPECT_THAT(html, HasSubstr("in 9 of 10 reaches; checked with simulated people only.")) << "what the interval is worth";
}

TEST_F(ChairReportTest, PageOfATrial_ShowsThePointsAtTheirTimes) {
  const Report report = report_of(write(three_reaches()));
  const std::string html = page(report, "trial-02.html");

  EXPECT_THAT(row(html, "Points and features of the reach", "P1: start of the reach"),
              ElementsAre("P1: start of the reach", "3.50", "mm", "0.50"));
  EXPECT_THAT(row(html, "Points and features of the reach", "P2: end of the reach initiation"), testing::Contains("0.70"));
  EXPECT_THAT(row(html, "Points and features of the reach", "P3: maximum"), ElementsAre("P3: maximum", "5.70", "mm", "1.50"));
  EXPECT_THAT(row(html, "Trunk movement", "90 % interval"), testing::Contains("44.3 to 60.8 \u00B0"));
  EXPECT_THAT(html, AllOf(HasSubstr(">P1<"), HasSubstr(">P2<"), HasSubstr(">P3<"), HasSubstr(">cue<")));
  EXPECT_THAT(html, HasSubstr("2026-11-21")) << "the time of the cue";
}

TEST_F(ChairReportTest, RejectedReach_IsListedWithItsReasons) {
  RecordProperty("requirement", "REP-8");
  MadeReaching made = three_reaches();
  made.reaches[2].movement.trunk_class = core::TrunkClass::Rejected;
  made.reaches[2].movement.probability = {0.3, 0.6, 0.1};
  made.reaches[2].movement.reasons = core::class_reason::kUnsure | core::class_reason::kBadReach;
  made.reaches[2].flags = core::reach_flag::kTimeout;
  const Report report = report_of(write(made));

  EXPECT_THAT(row(page(report, "session.html"), "Rejected reaches: no trunk class", "3"),
              ElementsAre("3", "150", "moderate, p 0.60", "no class is probable enough; the reach is doubtful; no return to rest"));
  EXPECT_THAT(row(page(report, "session.html"), "Trunk class by target, trials that are done", "150"),
              testing::Contains("moderate 1, rejected 1"));
  EXPECT_THAT(page(report, "trial-03.html"), AllOf(HasSubstr("No trunk class: no class is probable enough; the reach is doubtful."),
                                                   HasSubstr("About the reach: no return to rest.")));
}

TEST_F(ChairReportTest, TrialsThatDoNotCount_HavePagesAndAreNotInTheMeans) {
  MadeReaching made = three_reaches();
  made.reaches[2].outcome = "redone";
  made.reaches.push_back({.trial = 3, .rise_mm = 0.0, .attempt = 2});
  made.reaches.push_back({.trial = 4, .outcome = "aborted"});
  const Report report = report_of(write(made));
  const std::string html = page(report, "session.html");

  EXPECT_THAT(page(report, "trial-03.html"), HasSubstr("This trial was redone: it is not valid."));
  EXPECT_THAT(row(page(report, "trial-03.html"), "Trunk movement", "Trunk class"), testing::Contains("moderate")) << "it has its result";
  EXPECT_THAT(page(report, "trial-03-attempt-2.html"), HasSubstr("Not valid: no reach."));
  EXPECT_THAT(page(report, "trial-04.html"), HasSubstr("This trial was aborted: it is not valid."));
  EXPECT_THAT(row(html, "Trunk class by target, trials that are done", "150"),
              ElementsAre("150", "100.5", "2", "moderate 1, no reach 1", "1 of 1"));
  EXPECT_THAT(row(html, "Results of the session", "Trials done"), testing::Contains("3")) << "one of them is not valid";
  EXPECT_THAT(html, AllOf(HasSubstr("Trial 3: redone: not valid."), HasSubstr("Trial 3, attempt 2: done, not valid: no reach."),
                          HasSubstr("Trial 4: aborted: not valid.")));
}

TEST_F(ChairReportTest, AReachWithinTheArmsLength_NeedsNoReachOfTheSeat) {
  MadeReaching made;
  made.reaches = {{.trial = 1, .condition = "80", .target_cm = 53.6, .rise_mm = 0.0}};
  const std::string html = page(report_of(write(made)), "session.html");

  EXPECT_THAT(row(html, "Trials", "1"), testing::IsSupersetOf({"done", "no reach", "none"}));
  EXPECT_THAT(row(html, "Trunk class by target, trials that are done", "80"), testing::Contains("1 of 1"));
}

TEST_F(ChairReportTest, RecordedResultsThatDiffer_AreReported) {
  MadeReaching made = three_reaches();
  made.recorded_deg_more = 0.5;
  const Report report = report_of(write(made));

  EXPECT_THAT(page(report, "session.html"), HasSubstr("Live values of the daemon and values computed now differ in 3 of 3 trials"));
  EXPECT_THAT(page(report, "trial-01.html"), HasSubstr("Live values of the daemon and values computed now differ."));
}

TEST_F(ChairReportTest, WithoutMeasuresOfTheBody_ThereIsNoExpectationAndNoOwnScale) {
  MadeReaching made = three_reaches();
  made.facts.fields.clear();
  const std::string html = page(report_of(write(made)), "session.html");

  EXPECT_THAT(html, HasSubstr("Own scale: unknown: the session lacks measures of the body"));
  EXPECT_THAT(row(html, "Trials", "1"), testing::Contains("-"));
  made.facts.fields = {{"weight_kg", "68"}, {"height_cm", "175"}, {"arm_length_cm", "67"}, {"max_reach_cm", "124"}, {"group", "stroke"}};
  EXPECT_THAT(page(report_of(write(made, "b.xdf")), "session.html"), HasSubstr("Own scale: not used after a stroke"));
}

TEST_F(ChairReportTest, TrialsOfTheGeneralModel_AreNotPutOnTheOwnScale) {
  MadeReaching made = three_reaches();
  made.reaches[1].movement.reasons = core::class_reason::kCalibrated;
  auto chair = read_chair_session({.files = {write(made)}, .software = "test 1"}, always);
  ASSERT_TRUE(chair) << core::to_string(chair.error());
  chair->scale = classifier::SubjectCalibration{.max_d2_mm = 2.2, .max_flexion_deg = 52.0};

  EXPECT_THAT(scale_table(*chair).footnotes,
              ElementsAre("The classes and angles of 2 trials use the general model instead of this scale."));
  const Table consistency = consistency_table(*chair);
  ASSERT_EQ(consistency.rows.size(), 2U);
  EXPECT_EQ(consistency.rows[0].cells[3], "-");
  EXPECT_EQ(consistency.rows[1].cells[3], "100 %");
  EXPECT_EQ(movement_table(*chair, chair->trials[1]).rows.back().cells[0], "Rise d2 of own maximum");
  EXPECT_NE(movement_table(*chair, chair->trials[2]).rows.back().cells[0], "Rise d2 of own maximum");
}

TEST_F(ChairReportTest, AMaximumReachThatACorrectionTakesBack_IsNamedBesideTheOwnScale) {
  auto chair = read_chair_session({.files = {write(three_reaches())}, .software = "test 1"}, always);
  ASSERT_TRUE(chair) << core::to_string(chair.error());
  const auto take_back = [](ChairTrial& trial) { trial.recorded_outcome = std::exchange(trial.recorded.outcome, "rejected"); };
  take_back(chair->trials[0]);  // not at the maximum
  take_back(chair->trials[1]);
  EXPECT_THAT(session_content(*chair, SessionPageLimits{.trials = 9, .pictures = 9}).alerts, ElementsAre()) << "no scale";
  chair->scale = classifier::SubjectCalibration{.max_d2_mm = 2.2, .max_flexion_deg = 52.0};

  EXPECT_THAT(session_content(*chair, SessionPageLimits{.trials = 9, .pictures = 9}).alerts,
              ElementsAre("The own scale may contain the reach of trial 2, which was corrected to rejected."));
}

TEST_F(ChairReportTest, AMinorReach_IsNoneOrMinorAsInEveryOtherPlace) {
  MadeReaching made = three_reaches();
  for (std::size_t index : {0U, 1U}) made.reaches[index].movement.trunk_class = core::TrunkClass::Minor;
  made.reaches[0].movement.reasons = core::class_reason::kMinor;
  const Report report = report_of(write(made));

  EXPECT_EQ(row(page(report, "session.html"), "Trials", "1").at(4), "none or minor");
  EXPECT_EQ(row(page(report, "session.html"), "Trials", "2").at(4), "minor");
  EXPECT_THAT(row(page(report, "trial-01.html"), "Trunk movement", "Trunk class"), testing::Contains("none or minor"));
}

TEST_F(ChairReportTest, WithoutTrials_TheSessionHasItsPage) {
  const Report report = report_of(write(MadeReaching{}));

  ASSERT_EQ(report.pages.size(), 2U);
  EXPECT_THAT(report.pages[0].text, HasSubstr("No trial with a cue in this session."));
}

TEST_F(ChairReportTest, DamagedFile_IsNotReported) {
  const std::string file = write(three_reaches());
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(std::filesystem::file_size(file) / 2));
  stream.put('\x55');
  stream.put('\x55');
  stream.put('\x55');
  stream.close();

  const auto report = make_report({.files = {file}, .software = "test"}, always);

  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, core::ErrorCode::DataDamaged);
}

TEST_F(ChairReportTest, Stopped_WritesNothing) {
  const auto report = make_report({.files = {write(three_reaches())}, .software = "test"}, [](double) { return false; });

  ASSERT_FALSE(report);
  EXPECT_THAT(report.error().what, HasSubstr("interrupted"));
}

TEST(TransientTrace, Smoothed_IsTheMeanOf50MsAndKeepsGaps) {
  TransientTrace trace{.rate_hz = 100.0, .mm = {1.0, 1.0, 1.0, 1.0, 1.0, 6.0, 1.0, 1.0, 1.0, 1.0, 1.0}};

  const std::vector<double> smooth = trace.smoothed();

  ASSERT_EQ(smooth.size(), trace.mm.size());
  EXPECT_TRUE(std::isnan(smooth[0]));
  EXPECT_NEAR(smooth[5], 2.0, 1e-12);
  EXPECT_NEAR(smooth[7], 2.0, 1e-12) << "two samples on either side";
  EXPECT_NEAR(smooth[8], 1.0, 1e-12);
  trace.mm[5] = std::nan("");
  EXPECT_TRUE(std::isnan(trace.smoothed()[5]));
}

}  // namespace
}  // namespace dts::report
