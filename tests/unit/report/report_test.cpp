// SPDX-License-Identifier: Apache-2.0
#include "report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <pugixml.hpp>

#include "files/rig_file.h"
#include "made_decision.h"
#include "made_standing.h"
#include "record/xdf/recovery.h"
#include "report/decision_words.h"
#include "report/intended_use.h"
#include "report/measure_tables.h"
#include "report/number_text.h"
#include "report/reference_columns.h"
#include "report/session_data.h"
#include "session/session_events.h"
#include "unit/record/xdf_fixture.h"

namespace dts::report {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::pair<std::string, std::string>> kOpen{{"eyes", "open"}, {"feet", "two"}};
const std::vector<std::pair<std::string, std::string>> kClosed{{"eyes", "closed"}, {"feet", "two"}};

/// The daemon's result of a trial with a decision.
v1::Event decided(std::uint32_t trial, const std::string& condition, const v1::SteadinessDecision& decision) {
  session::SwayTrialResult result{.trial = trial, .condition = condition, .analysis = posturography::Analysis{}, .decision = decision};
  result.analysis->rate_hz = 100.0;
  result.analysis->samples = 2000;
  result.analysis->duration_s = 20.0;
  v1::Event event = session::to_event(result, "20261121T144525Z-floor-1", "dtsd 0.2.0");
  event.set_scan(4900);
  return event;
}

v1::SteadinessDecision outside_of(const std::string& measure) {
  v1::SteadinessDecision decision = made_decision();
  decision.set_outcome(v1::DECISION_OUTCOME_OUTSIDE);
  decision.add_outside(measure);
  return decision;
}

std::size_t times_in(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

class ReportTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string write(const MadeStanding& made, const std::string& name = "a.xdf") {
    return write_standing(directory_ / name, made);
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
  static MadeStanding two_trials() {
    MadeStanding made{.length_s = 50.0};
    add_trial(made, 1, 2.0, 20.0, "eyes-open", kOpen);
    add_trial(made, 2, 25.0, 20.0, "eyes-closed", kClosed);
    return made;
  }
  static void expect_well_formed(const Report& report) {
    for (const Page& each : report.pages) {
      pugi::xml_document document;
      const auto parsed = document.load_string(each.text.c_str(), pugi::parse_default | pugi::parse_doctype);
      EXPECT_TRUE(parsed) << each.file << ": " << parsed.description() << " at "
                          << each.text.substr(static_cast<std::size_t>(parsed.offset), 80);
      EXPECT_LT(each.text.size(), 1'000'000U) << each.file;
      EXPECT_EQ(each.text.find("nan"), std::string::npos) << each.file << each.text.substr(each.text.find("nan") - 60, 100);
      EXPECT_NE(each.text.substr(0, 1024).find(kPageMark), std::string::npos) << each.file;
    }
  }

  record::xdf_test::Folder directory_;
};

TEST_F(ReportTest, OfNoRecording_Fails) {
  EXPECT_FALSE(make_report({.files = {"no/such/file.xdf"}, .software = "test"}, always));
  EXPECT_FALSE(make_report({.files = {}, .software = "test"}, always));
}

TEST_F(ReportTest, OfTrials_IsAPageForEachAndOneForTheSession) {
  const Report report = report_of(write(two_trials()));

  std::vector<std::string> files;
  for (const Page& each : report.pages) files.push_back(each.file);
  EXPECT_THAT(files, ElementsAre("session.html", "session.svg", "trial-01.html", "trial-01.svg", "trial-02.html", "trial-02.svg"));
  EXPECT_EQ(report.session_id, "20261121T144525Z-floor-1");
  expect_well_formed(report);
}

TEST_F(ReportTest, TheSameRecording_GivesTheSameBytes) {
  RecordProperty("requirement", "REP-1");
  const std::string file = write(two_trials());
  const std::string elsewhere = directory_ / "folder";
  std::filesystem::create_directory(elsewhere);
  std::filesystem::copy_file(file, elsewhere + "/a.xdf");
  std::filesystem::copy_file(file + ".idx", elsewhere + "/a.xdf.idx");

  const Report first = report_of(file);
  const Report second = report_of(elsewhere + "/a.xdf");

  ASSERT_EQ(first.pages.size(), second.pages.size());
  for (std::size_t index = 0; index < first.pages.size(); ++index) {
    EXPECT_EQ(first.pages[index].text, second.pages[index].text) << first.pages[index].file;
  }
}

TEST_F(ReportTest, ValuesOfAPage_AreThoseOfTheAnalysis) {
  RecordProperty("requirement", "REP-2");
  const std::string file = write(two_trials());
  const auto session = read_session({.files = {file}, .software = "test"}, always);
  ASSERT_TRUE(session.has_value());
  const auto again = posturography::analyse(session->trials[0].recorded.cop, {.preparation = posturography::kReportPreparation});
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ(again->samples, 2000U);

  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(page(report_of(file), "trial-01.html").c_str()));
  const auto value_beside = [&](const std::string& name, int column) {
    const std::string path = "//tr[td[1]='" + name + "']/td[" + std::to_string(column) + "]";
    return std::string(document.select_node(path.c_str()).node().text().as_string());
  };
  using posturography::Measure;
  EXPECT_EQ(value_beside("Mean velocity", 2), significant(*again->measures.get(Measure::Mvelo)));
  EXPECT_EQ(value_beside("Mean velocity (MVELO)", 3), significant(*again->measures.get(Measure::MveloAp)));
  EXPECT_EQ(value_beside("Range between two points (RANGE)", 4), significant(*again->measures.get(Measure::RangeMl)));
  EXPECT_EQ(value_beside("95 % prediction ellipse (PEA95-F)", 2), significant(*again->measures.get(Measure::Pea95F)));
  EXPECT_EQ(value_beside("Median frequency (PF50)", 3), significant(*again->measures.get(Measure::Pf50Ap)));
  EXPECT_EQ(value_beside("Sample entropy, m = 2, r = 0.2, 20 Hz", 4), significant(*again->measures.get(Measure::SampenMl)));
}

TEST_F(ReportTest, EveryMeasure_HasItsPlaceInTheTable) {
  TrialData trial;
  trial.analysis.emplace();
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    trial.analysis->measures.set(static_cast<posturography::Measure>(index), 1000.0 + static_cast<double>(index));
  }
  std::vector<std::string> cells;
  for (const Row& row : all_measures(trial).rows) cells.insert(cells.end(), row.cells.begin(), row.cells.end());

  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    EXPECT_EQ(std::ranges::count(cells, std::to_string(1000 + index)), 1)
        << posturography::info(static_cast<posturography::Measure>(index)).symbol;
  }
}

TEST_F(ReportTest, Page_SaysWhoWhenAndWhereFrom) {
  const std::string text = page(report_of(write(two_trials())), "trial-02.html");

  EXPECT_THAT(text, AllOf(HasSubstr("P017"), HasSubstr("quiet-standing"), HasSubstr("eyes closed, feet two"),
                          HasSubstr("dtsd 0.1.0; computed by test 1"), HasSubstr("USB-6008, serial 0123"),
                          HasSubstr("a.xdf, complete, SHA-256 "), HasSubstr("window_filter window_scans=3")));
  EXPECT_THAT(text, HasSubstr("2026-11-21 14:45:50 UTC")) << "25 s after the segment began";
  EXPECT_THAT(text, HasSubstr("1.05 mm (RMSE; "));
  EXPECT_THAT(text, AllOf(HasSubstr("Methods, for a paper"),
                          HasSubstr("analysed at 100.0 Hz (Butterworth low-pass of 4th order, 10 Hz, forward and backward)"),
                          HasSubstr("Prieto et al. (1996)")));
  EXPECT_THAT(text, AllOf(Not(HasSubstr("abnormal")), Not(HasSubstr("Synthetic"))));
  EXPECT_THAT(text, Not(HasSubstr(std::filesystem::path(directory_ / "x").parent_path().string()))) << "folders are of one machine";
}

TEST_F(ReportTest, RepairedCopy_SaysSoBesideItsChecksum) {
  const std::string file = write(two_trials());
  std::filesystem::rename(file, file + ".part");
  const auto recovered = record::recover(file + ".part", record::recovered_name(file + ".part"));
  ASSERT_TRUE(recovered) << recovered.error().what;

  EXPECT_THAT(page(report_of(recovered->file), "session.html"), HasSubstr("a.recovered.xdf, recovered, SHA-256 " + recovered->sha256));
}

TEST_F(ReportTest, SimulatedData_AreCalledSynthetic) {
  RecordProperty("requirement", "REP-3");
  MadeStanding made = two_trials();
  made.facts.device_uri = "sim:floor?seed=3";
  const Report report = report_of(write(made));

  for (const Page& each : report.pages) EXPECT_THAT(each.text, HasSubstr("Synthetic data")) << each.file;
}

TEST_F(ReportTest, ReplayedData_AreCalledSo) {
  RecordProperty("requirement", "REP-3");
  MadeStanding made = two_trials();
  made.facts.device_uri = "replay:/var/lib/dtsd/a.xdf";
  const Report report = report_of(write(made));

  for (const Page& each : report.pages) EXPECT_THAT(each.text, HasSubstr("A recording was played on this rig")) << each.file;
}

TEST_F(ReportTest, References_AreShownOnlyWhereTheLabelsMatch) {
  RecordProperty("requirement", "SWAY-7");
  MadeStanding made{.length_s = 100.0};
  add_trial(made, 1, 1.0, 20.0, "a", kOpen);
  add_trial(made, 2, 25.0, 20.0, "b", {{"eyes", "open"}, {"feet", "one"}});
  add_trial(made, 3, 50.0, 20.0, "c", {{"eyes", "open"}, {"feet", "two"}, {"surface", "grass"}});
  add_trial(made, 4, 75.0, 20.0, "d", {});
  made.length_s = 125.0;
  add_trial(made, 5, 100.0, 20.0, "e-feedback", {{"eyes", "open"}, {"feedback", "cop"}, {"feet", "two"}});
  made.length_s = 150.0;
  add_trial(made, 6, 125.0, 20.0, "counting", {{"eyes", "open"}, {"feet", "two"}, {"surface", "firm"}, {"task", "counting"}});
  const Report report = report_of(write(made));

  EXPECT_THAT(page(report, "trial-01.html"), AllOf(HasSubstr("Ref. 1"), HasSubstr("Santos"), HasSubstr("a firm surface is assumed"),
                                                   HasSubstr("The reference ranges are from trials of 60 s; this trial has 20.0 s")));
  for (const char* name : {"trial-02.html", "trial-03.html", "trial-04.html", "trial-05.html", "trial-06.html"})
    EXPECT_THAT(page(report, name), Not(HasSubstr("Ref. 1"))) << name;
}

TEST_F(ReportTest, TrialWithFeedback_IsNotInTheQuotientAndSaysSo) {
  MadeStanding made = two_trials();
  made.length_s = 75.0;
  add_trial(made, 3, 50.0, 20.0, "eyes-open-feedback", {{"eyes", "open"}, {"feedback", "cop"}, {"feet", "two"}});
  const Report report = report_of(write(made));

  EXPECT_THAT(page(report, "trial-03.html"), AllOf(HasSubstr("With feedback: the subject saw the own COP."), HasSubstr("feedback cop")));
  EXPECT_THAT(page(report, "trial-01.html"), Not(HasSubstr("With feedback")));
  EXPECT_THAT(page(report, "session.html"), AllOf(HasSubstr(">feet two</th>"), HasSubstr("eyes-open-feedback (n = 1)"),
                                                  HasSubstr("eyes-open (n = 1)"), Not(HasSubstr("feedback cop"))));
}

TEST(ReferenceColumns, Ranges_HaveTheDigitsThatWerePublished) {
  const auto protocols = posturography::reference_protocols();
  const auto text = [&](std::size_t protocol, posturography::Measure measure) { return range_text(protocols[protocol], measure); };
  using posturography::Measure;

  EXPECT_EQ(text(0, Measure::Pea95F), "223 (91-480)");
  EXPECT_EQ(text(0, Measure::AreaSw), "12.2 (5.6-26.6)");
  EXPECT_EQ(text(0, Measure::Mfreq), "0.286 (0.19-0.51)");
  EXPECT_EQ(text(1, Measure::Rdist), "6.00 (3.56-9.56)");
  EXPECT_EQ(text(2, Measure::Mdist), "11.1 (8.5-14.8)");
  EXPECT_EQ(text(0, Measure::SdaHsAp), "0.846 (0.77-0.90)");
  EXPECT_EQ(text(2, Measure::Pea95F), "1449 (858-2403)");
  EXPECT_EQ(text(0, Measure::SampenAp), "");
}

// Below 80 rem two tables are wider than a screen: they stand one below the other there, and pictures side by side.
TEST_F(ReportTest, SectionsOfTables_AreToldFromPictures) {
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(page(report_of(write(two_trials())), "trial-01.html").c_str()));

  EXPECT_EQ(document.select_nodes("//section[@class='pictures']/div/figure").size(), 3U);
  EXPECT_EQ(document.select_nodes("//section[@class='tables']//table").size(), 2U);
  EXPECT_EQ(document.select_nodes("//section").size(), 2U);
}

TEST_F(ReportTest, PublishedQuotients_OnlyOfTheStanceThatTheyAreOf) {
  MadeStanding made{.length_s = 50.0};
  add_trial(made, 1, 2.0, 20.0, "eyes-open", {{"eyes", "open"}});
  add_trial(made, 2, 25.0, 20.0, "eyes-closed", {{"eyes", "closed"}});
  const std::string text = page(report_of(write(made)), "session.html");
  EXPECT_THAT(text, AllOf(HasSubstr("Romberg quotient"), Not(HasSubstr("1.11 (0.80-1.32)"))));

  MadeStanding counting{.length_s = 50.0};
  add_trial(counting, 1, 2.0, 20.0, "eyes-open", {{"eyes", "open"}, {"feet", "two"}, {"task", "counting"}});
  add_trial(counting, 2, 25.0, 20.0, "eyes-closed", {{"eyes", "closed"}, {"feet", "two"}, {"task", "counting"}});
  const std::string another = page(report_of(write(counting, "counting.xdf")), "session.html");
  EXPECT_THAT(another, AllOf(HasSubstr("Romberg quotient"), Not(HasSubstr("1.11 (0.80-1.32)")))) << "another task";
}

TEST_F(ReportTest, MeansSayHowManyTrialsAreInThem) {
  MadeStanding made{.length_s = 100.0};
  made.ml_mm = [](double t_s) { return t_s > 40.0 && t_s < 42.0 ? std::numeric_limits<double>::quiet_NaN() : made_sway(t_s, 0.3); };
  add_trial(made, 1, 1.0, 20.0, "eyes-open", kOpen);
  add_trial(made, 2, 30.0, 20.0, "eyes-open", kOpen);
  add_trial(made, 3, 60.0, 20.0, "eyes-open", kOpen);
  add_trial(made, 4, 35.0, 12.0, "none is whole", kOpen);
  EXPECT_THAT(page(report_of(write(made)), "session.html"), AllOf(HasSubstr("eyes-open (n = 2)"), HasSubstr("none is whole (n = 1)")));
}

TEST_F(ReportTest, SessionPage_HasMeansQuotientsAndWhatWasLeftOut) {
  MadeStanding made = two_trials();
  made.length_s = 100.0;
  add_trial(made, 3, 50.0, 20.0, "eyes-open", kOpen, "rejected");
  add_trial(made, 4, 75.0, 20.0, "eyes-open", kOpen, "redone");
  const std::string text = page(report_of(write(made)), "session.html");

  EXPECT_THAT(text, AllOf(HasSubstr("Romberg quotient"), HasSubstr("1.11 (0.80-1.32)"), HasSubstr("below 1 is common and not an error"),
                          HasSubstr("The trials of this session have 20.0 s: do not compare them with the published values.")));
  EXPECT_THAT(text, AllOf(HasSubstr("Trial 3: rejected: not valid."), HasSubstr("Trial 4: redone: not valid.")));
  EXPECT_THAT(text, AllOf(HasSubstr("eyes-open (n = 1)"), HasSubstr(">feet two</th>")));
  EXPECT_THAT(text, HasSubstr("href=\"trial-03.html\""));
}

TEST_F(ReportTest, Pages_NameConditionsFieldsAndProtocolLikeTheProtocol) {
  MadeStanding made = two_trials();
  made.facts.protocol = "romberg";
  made.facts.fields = {{"weight_kg", "71.5"}, {"shoes", "barefoot"}};
  made.facts.protocol_definition =
      "name = \"romberg\"\ntitle = \"Romberg's test\"\n[[field]]\nname = \"weight_kg\"\nlabel = \"Body weight\"\nunit = \"kg\"\nminimum = "
      "10\n"
      "maximum = 250\n[trials]\n[[trials.condition]]\nname = \"eyes-open\"\ntitle = \"Eyes open\"\n[[trials.condition]]\n"
      "name = \"eyes-closed\"\n";
  const Report report = report_of(write(made));
  const std::string session = page(report, "session.html");

  for (const char* part :
       {"Romberg&apos;s test (romberg)", "Body weight", "71.5 kg", "shoes", "Eyes open (n = 1)", "eyes-closed (n = 1)"}) {
    EXPECT_THAT(session, HasSubstr(part));
  }
  EXPECT_THAT(session, HasSubstr("<title>P017, Romberg&apos;s test, 21 Nov 2026: quiet standing</title>"));
  EXPECT_THAT(page(report, "trial-01.html"), HasSubstr(", trial 1: Eyes open</title>"));
}

TEST_F(ReportTest, MissingQuotient_HasAReason) {
  MadeStanding made{.length_s = 50.0};
  add_trial(made, 1, 2.0, 20.0, "eyes-open", kOpen);
  add_trial(made, 2, 25.0, 20.0, "eyes-closed", {{"eyes", "closed"}, {"feet", "two"}}, "rejected");
  EXPECT_THAT(page(report_of(write(made)), "session.html"),
              HasSubstr("No Romberg quotient for feet two: no trial with eyes closed counts."));
}

TEST_F(ReportTest, Quotient_IsThatOfTheMeans) {
  const std::string file = write(two_trials());
  const auto session = read_session({.files = {file}, .software = "test"}, always);
  ASSERT_TRUE(session.has_value());
  using posturography::Measure;
  const double open = *session->trials[0].analysis->measures.get(Measure::Mvelo);
  const double closed = *session->trials[1].analysis->measures.get(Measure::Mvelo);

  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(page(report_of(file), "session.html").c_str()));
  const auto cells = document.select_nodes("//tr[td[1]='Mean velocity (MVELO)']/td[2]");
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_STREQ(cells[1].node().text().as_string(), significant(closed / open).c_str());
}

TEST_F(ReportTest, WithoutTrials_EveryStandingIsAPage) {
  MadeStanding made{.length_s = 45.0};
  const auto steps_off = [](const std::function<double(double)>& mm) {
    return [mm](double t_s) { return t_s > 20.0 && t_s < 25.0 ? std::numeric_limits<double>::quiet_NaN() : mm(t_s); };
  };
  made.ml_mm = steps_off(made.ml_mm);
  made.ap_mm = steps_off(made.ap_mm);
  const Report report = report_of(write(made));

  ASSERT_EQ(report.pages.size(), 6U);
  EXPECT_EQ(report.pages[4].file, "standing-02.html");
  expect_well_formed(report);
}

TEST_F(ReportTest, HostileTexts_AreEscaped) {
  RecordProperty("requirement", "SEC-7");
  const std::string bad = "</title><script>alert(\"1\")</script> ' & \x01\x1b[31m \xff\xfe {{title}} {{{svg}}}";
  MadeStanding made{.length_s = 30.0};
  made.facts.subject = made.facts.label = made.facts.protocol = made.facts.device_model = made.facts.session_id = bad;
  made.facts.fields = {{bad, bad}};
  add_trial(made, 1, 1.0, 20.0, bad, {{"eyes", bad}});
  const Report report = report_of(write(made));

  expect_well_formed(report);
  for (const Page& each : report.pages) {
    EXPECT_THAT(each.text, AllOf(Not(HasSubstr("<script")), Not(HasSubstr("\x1b")), Not(HasSubstr("\xff")))) << each.file;
  }
  EXPECT_THAT(page(report, "trial-01.html"), HasSubstr("{{title}}")) << "texts are no templates";
}

TEST_F(ReportTest, CorrectedValues_AreShownWithTheRecordedOnes) {
  const std::string file = write(two_trials());
  const record::SessionFacts facts = *record::Recording::open(file).value()->session();
  record::Corrections corrections{.session_id = facts.session_id};
  corrections.add({.who = "local:anna",
                   .field = record::CorrectedField::Subject,
                   .old_value = facts.subject,
                   .new_value = "P099",
                   .reason = "<script>alert(1)</script>"});
  corrections.add({.who = "local",
                   .field = record::CorrectedField::Outcome,
                   .part = 1,
                   .trial = 2,
                   .attempt = 1,
                   .old_value = "done",
                   .new_value = "rejected",
                   .reason = "talked"});
  ASSERT_TRUE(record::write_corrections(record::corrections_file(file, facts.session_id), corrections));

  const Report report = report_of(file);
  const std::string session = page(report, "session.html");
  EXPECT_THAT(session, HasSubstr("P099 (corrected; recorded: " + facts.subject + ")"));
  EXPECT_THAT(session, HasSubstr("rejected: not valid (corrected; recorded: done)"));
  EXPECT_THAT(session, HasSubstr("local:anna: &lt;script&gt;alert(1)"));
  EXPECT_EQ(session.find("<script"), std::string::npos);
  EXPECT_THAT(session, Not(HasSubstr("Romberg quotient</"))) << "one of its conditions has no valid trial";
  EXPECT_THAT(page(report, "trial-01.html"), HasSubstr("P099"));
  expect_well_formed(report);
}

TEST_F(ReportTest, ForTheRecordOfAPerson_HasNoFreeTextAndNoValueBeforeACorrection) {
  MadeStanding made = two_trials();
  made.facts.label = "first day";
  const std::string file = write(made);
  record::Corrections corrections{.session_id = made.facts.session_id};
  corrections.add({.who = "local:anna",
                   .field = record::CorrectedField::Subject,
                   .old_value = made.facts.subject,
                   .new_value = "S099",
                   .reason = "mixed up"});
  corrections.add({.who = "local:anna", .field = record::CorrectedField::Notes, .new_value = "asked her sister", .reason = "a note"});
  ASSERT_TRUE(record::write_corrections(record::corrections_file(file, made.facts.session_id), corrections));

  const auto report = make_report({.files = {file}, .software = "test 1", .for_record = true}, always);

  ASSERT_TRUE(report) << core::to_string(report.error());
  const std::string session = page(*report, "session.html");
  EXPECT_THAT(session, HasSubstr("S099"));
  for (const std::string& text : {made.facts.subject, std::string("anna"), std::string("mixed up"), std::string("sister"),
                                  std::string("first day"), std::string("Corrections")}) {
    EXPECT_THAT(session, Not(HasSubstr(text)));
  }
}

TEST_F(ReportTest, Page_FetchesNothing) {
  for (const Page& each : report_of(write(two_trials())).pages) {
    EXPECT_THAT(each.text, AllOf(Not(HasSubstr("<script")), Not(HasSubstr("src=")), Not(HasSubstr("url(")), Not(HasSubstr("@import")),
                                 Not(HasSubstr("<link"))));
    if (each.file.ends_with(".html")) {
      EXPECT_THAT(each.text, HasSubstr("default-src 'none'; style-src 'unsafe-inline'"));
    }
  }
}

TEST_F(ReportTest, Decision_IsOnThePagesWithItsLimits) {
  RecordProperty("requirement", "SWAY-10");
  MadeStanding made = two_trials();
  made.events = {decided(1, "eyes-open", made_decision()), decided(2, "eyes-closed", outside_of("MVELO"))};

  const Report report = report_of(write(made));

  const std::string session = page(report, "session.html");
  for (const char* part : {"like under60, p 0.83", "no decision: MVELO is outside of the training", "trained on 124 people"}) {
    EXPECT_THAT(session, HasSubstr(part));
  }
  EXPECT_EQ(times_in(session, std::string(kDecisionLimit)), 1U) << "one model, one limit";
  const std::string trial = page(report, "trial-02.html");
  EXPECT_THAT(trial, AllOf(HasSubstr("no decision: MVELO"), HasSubstr(std::string(kDecisionLimit)), Not(HasSubstr("under60"))));
  EXPECT_THAT(page(report, "trial-01.svg"), HasSubstr("like under60, p 0.83"));
  expect_well_formed(report);
}

TEST_F(ReportTest, Decision_IsLeftOutOfATrialThatDoesNotCountAndOfARecord) {
  MadeStanding made = two_trials();
  made.events = {decided(1, "eyes-open", made_decision())};
  EXPECT_THAT(page(report_of(write(two_trials(), "none.xdf")), "session.html"), Not(HasSubstr("steadiness model")));
  const std::string file = write(made, "decided.xdf");
  const auto record = make_report({.files = {file}, .software = "test 1", .for_record = true}, always);
  ASSERT_TRUE(record);
  EXPECT_THAT(page(*record, "session.html"), Not(HasSubstr("under60"))) << "a decision is no finding";

  for (MadeStep& step : made.steps) {
    if (step.phase == "done" && step.trial == 1) step.phase = "rejected";
  }
  EXPECT_THAT(page(report_of(write(made, "rejected.xdf")), "session.html"), Not(HasSubstr("under60")));
}

TEST_F(ReportTest, EveryPage_SaysWhatItIsFor) {
  RecordProperty("requirement", "REP-11");
  for (const Page& each : report_of(write(two_trials())).pages) {
    EXPECT_EQ(times_in(each.text, std::string(kIntendedUse)), 1U) << each.file;
  }
}

TEST_F(ReportTest, OddTrials_DoNotBreakAPage) {
  MadeStanding made{.length_s = 120.0};
  made.ml_mm = [](double t_s) { return t_s < 30.0 ? 5.0 : made_sway(t_s, 0.3); };
  made.ap_mm = [](double t_s) {
    return t_s < 30.0 ? 5.0 : (t_s > 60.0 && t_s < 61.0 ? std::numeric_limits<double>::quiet_NaN() : made_sway(t_s, 0.8));
  };
  add_trial(made, 1, 1.0, 20.0, "at rest", kOpen);
  add_trial(made, 2, 35.0, 0.01, "one sample", kOpen);
  add_trial(made, 3, 36.0, 5.0, "short", kOpen);
  add_trial(made, 4, 50.0, 30.0, "with a gap", kOpen);
  add_trial(made, 5, 500.0, 20.0, "not recorded", kOpen);
  const Report report = report_of(write(made));

  expect_well_formed(report);
  EXPECT_THAT(page(report, "trial-01.html"), HasSubstr("not defined: the COP does not move"));
  EXPECT_THAT(page(report, "trial-02.html"), HasSubstr("No values: "));
  EXPECT_THAT(page(report, "trial-03.html"), HasSubstr("no spectrum: needs 10 s and 200 samples"));
  EXPECT_THAT(page(report, "trial-04.html"), HasSubstr("cut_at_gap"));
  EXPECT_THAT(
      page(report, "session.html"),
      HasSubstr("Trial 4: samples are missing; only the longest part without a gap was analysed: 19.0 s. The trial is in a mean only"));
  EXPECT_THAT(page(report, "trial-05.html"), HasSubstr("no sample of the centre of pressure"));
}

TEST_F(ReportTest, LongTrial_StaysBelowOneMegabyte) {
  MadeStanding made{.rate_hz = 1000, .length_s = 300.0};
  add_trial(made, 1, 1.0, 290.0, "long", kOpen);
  expect_well_formed(report_of(write(made)));
}

TEST_F(ReportTest, RecordingWithoutACentreOfPressure_IsRefusedWithAWord) {
  const auto report = make_report({.files = {write({.length_s = 20.0, .has_cop = false})}, .software = "test"}, always);

  ASSERT_FALSE(report.has_value());
  EXPECT_EQ(report.error().code, core::ErrorCode::NotFound);
  EXPECT_THAT(report.error().what, HasSubstr("no centre of pressure and no reaches"));
}

TEST_F(ReportTest, WhoeverNoLongerWaits_IsObeyed) {
  const std::string file = write(two_trials());
  for (const int calls : {0, 3, 20}) {
    int asked = 0;
    const auto report = make_report({.files = {file}, .software = "test"}, [&](double) { return asked++ < calls; });
    ASSERT_FALSE(report.has_value()) << calls;
    EXPECT_THAT(report.error().what, HasSubstr("interrupted"));
  }
}

TEST_F(ReportTest, LoadOnTwoFeet_IsShownWithHowItWasCorrected) {
  MadeStanding made = two_trials();
  made.facts.fields = {{"weight_kg", "60"}};
  const std::string before = page(report_of(write(made)), "session.html");
  EXPECT_THAT(before, HasSubstr("not corrected: on two feet the load reads too low"));
  EXPECT_THAT(before, Not(HasSubstr("about 71 kg")));

  made.facts.rig_definition = files::rig_definition(std::string(DTS_SOURCE_DIR) + "/config/rigs/floor-sim.toml").value_or("");
  const std::string about = page(report_of(write(made, "b.xdf")), "session.html");
  EXPECT_THAT(about, HasSubstr("Load: about 71 kg, corrected for two feet without a stance width; stated weight is doubtful: 60 kg."));
  EXPECT_THAT(about, HasSubstr("load and position are corrected for a person on two feet"));

  made.facts.fields = {{"weight_kg", "70"}, {"stance_width_mm", "180"}};
  const std::string stated = page(report_of(write(made, "c.xdf")), "session.html");
  EXPECT_THAT(stated, HasSubstr("71.4 kg, corrected for two feet with the stated stance width of 180 mm"));
  EXPECT_THAT(stated, Not(HasSubstr("doubtful:")));
}

TEST_F(ReportTest, RigDefinition_GivesThePlateUnlessItIsBroken) {
  MadeStanding made = two_trials();
  made.facts.rig_definition = files::rig_definition(std::string(DTS_SOURCE_DIR) + "/config/rigs/floor-sim.toml").value_or("");
  EXPECT_THAT(page(report_of(write(made)), "trial-01.svg"), HasSubstr("plate, 430 x"));
  made.facts.rig_definition = "this is no TOML [";
  EXPECT_THAT(page(report_of(write(made, "b.xdf")), "trial-01.svg"), Not(HasSubstr("drawn area on")));
}

}  // namespace
}  // namespace dts::report
