// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "dts/wire/event_json.h"
#include "record/catalogue/corrections.h"
#include "session/session_events.h"
#include "support/event_text.h"
#include "unit/lab/sway/sway_files.h"
#include "unit/record/xdf_fixture.h"

namespace dts::lab::sway {
namespace {

using session::TrialEvent;
using session::TrialEventKind;
using test::event_of;
using ::testing::HasSubstr;

constexpr std::uint64_t kScans = 4000;

double ml_mm(std::uint64_t scan) {
  return 3.0 * std::sin(0.031 * static_cast<double>(scan)) + std::sin(0.0107 * static_cast<double>(scan));
}
double ap_mm(std::uint64_t scan) {
  return 4.0 * std::sin(0.023 * static_cast<double>(scan)) + std::cos(0.0071 * static_cast<double>(scan));
}

v1::Event step(TrialEventKind kind, std::uint32_t trial, const std::string& eyes, std::uint64_t scan) {
  v1::Event event = to_event(TrialEvent{.kind = kind, .trial = trial, .condition = "eyes-" + eyes, .labels = {{"eyes", eyes}}}, "s1");
  event.set_scan(scan);
  return event;
}

/// As dtsd tells it, with a wrong mean velocity if asked for.
v1::Event told(std::uint32_t trial, const std::string& eyes, std::uint64_t first, std::uint64_t end, double wrong_by) {
  posturography::CopSeries series{.rate_hz = 100.0, .ml_mm = {}, .ap_mm = {}};
  for (std::uint64_t scan = first; scan < end; ++scan) {
    series.ml_mm.push_back(ml_mm(scan));
    series.ap_mm.push_back(ap_mm(scan));
  }
  session::SwayTrialResult result{.trial = trial, .condition = "eyes-" + eyes, .labels = {{"eyes", eyes}}};
  result.first_scan = {first};
  result.end_scan = {end};
  result.analysis = posturography::analyse(series, {.preparation = posturography::kReportPreparation}).value();
  const double velocity = result.analysis->measures.get(posturography::Measure::Mvelo).value_or(0.0);
  result.analysis->measures.set(posturography::Measure::Mvelo, velocity + wrong_by);
  v1::Event event = to_event(result, "s1", "dtsd test");
  event.set_scan(end);
  return event;
}

class RecordedTrialsTest : public RunTest {
 protected:
  /// Two trials of 12 s that count, and one that was aborted.
  std::string recording(double wrong_by) {
    using namespace record::xdf_test;
    std::string file = path("session.xdf");
    auto writer = record::XdfWriter::create(file, to_facts(floor_session())).value();
    const auto raw = writer->add_stream(regular_stream("floor/raw", {"w1_v"}, rate_of(100)));
    const auto cop = writer->add_stream(regular_stream("floor/cop", {"ml_mm", "ap_mm"}, rate_of(100)));
    const auto events = writer->add_stream(events_stream());
    std::vector<double> values;
    for (std::uint64_t scan = 0; scan < kScans; ++scan) values.insert(values.end(), {ml_mm(scan), ap_mm(scan)});
    const record::XdfWriter::Position start{.segment = 0, .first_scan = {0}};
    const std::vector<v1::Event> all{event_of("segment_start {}"),
                                     step(TrialEventKind::Measure, 1, "open", 100),
                                     step(TrialEventKind::Done, 1, "open", 1300),
                                     told(1, "open", 100, 1300, 0.0),
                                     step(TrialEventKind::Measure, 2, "closed", 1400),
                                     step(TrialEventKind::Done, 2, "closed", 2600),
                                     told(2, "closed", 1400, 2600, wrong_by),
                                     step(TrialEventKind::Measure, 3, "open", 2700),
                                     step(TrialEventKind::Aborted, 3, "open", 3900)};
    std::vector<std::pair<double, std::string>> texts;
    for (const v1::Event& event : all) texts.emplace_back(1000.0 + 0.01 * static_cast<double>(event.scan()), wire::to_json(event));
    EXPECT_TRUE(writer->write_texts(events, std::span(texts).first(1), start));
    EXPECT_TRUE(writer->write_samples(raw, 1000.0, std::vector<double>(kScans, 0.0), start));
    EXPECT_TRUE(writer->write_samples(cop, 1000.0, values, start));
    EXPECT_TRUE(writer->write_texts(events, std::span(texts).subspan(1), {.segment = 0, .first_scan = {kScans}}));
    EXPECT_TRUE(writer->close());
    return file;
  }
};

TEST_F(RecordedTrialsTest, TrialsThatCount_AreMeasuredAndComparedWithWhatWasTold) {
  const std::string file = recording(0.0);

  ASSERT_EQ(run_with({"sway", file, "--json"}), cli::kOk) << talk();
  ASSERT_EQ(json().at("trials").size(), 2U);
  const auto second = json().at("trials").at(1);
  EXPECT_EQ(second.at("session"), "20261121T144525Z-floor-1");
  EXPECT_EQ(second.at("subject"), "P017");
  EXPECT_EQ(second.at("trial"), 2);
  EXPECT_EQ(second.at("attempt"), 1);
  EXPECT_EQ(second.at("condition"), "eyes-closed");
  EXPECT_EQ(second.at("labels").at("eyes"), "closed");
  EXPECT_EQ(second.at("n"), 1200);
  EXPECT_EQ(json().at("recorded_results"), 2);
  EXPECT_EQ(json().at("differing_results"), 0);

  ASSERT_EQ(run_with({"sway", file, "--all", "--label", "surface=foam", "--label", "eyes=shut", "--json"}), cli::kOk) << talk();
  ASSERT_EQ(json().at("trials").size(), 3U);
  EXPECT_EQ(json().at("trials").at(2).at("outcome"), "aborted");
  EXPECT_EQ(json().at("trials").at(2).at("labels").at("surface"), "foam");
  EXPECT_EQ(json().at("trials").at(2).at("labels").at("eyes"), "open") << "what was recorded goes before what is given";
  ASSERT_EQ(run_with({"sway", file, "--trials", "2", "--profile", "asis", "--json"}), cli::kOk) << talk();
  EXPECT_EQ(json().at("trials").size(), 1U);
  EXPECT_EQ(json().at("recorded_results"), 0) << "another definition than what was told";
}

TEST_F(RecordedTrialsTest, OneRecording_HasTheResultsOfTheSession_OfTheTrialsThatCount) {
  const std::string file = recording(0.0);

  ASSERT_EQ(run_with({"sway", file, "--all", "--json"}), cli::kOk) << talk();
  const auto summary = json().at("summary");
  const auto found = [&](const std::string& name) {
    return std::ranges::find_if(summary, [&](const auto& figure) { return figure.at("name") == name; });
  };
  ASSERT_NE(found("eyes-open/MVELO"), summary.end()) << summary;
  ASSERT_NE(found("romberg/MVELO"), summary.end()) << summary;
  EXPECT_EQ(found("eyes-open/MVELO")->at("value"), json().at("trials").at(0).at("measures").at("MVELO").at("value"));
  EXPECT_EQ(found("eyes-open/MVELO")->at("unit"), "mm/s");
  EXPECT_EQ(found("eyes-open/MVELO")->at("details").at("trials"), 1) << "the aborted trial does not count";

  ASSERT_EQ(run_with({"sway", file, file, "--json"}), cli::kOk) << talk();
  EXPECT_FALSE(json().contains("summary")) << "of several recordings";
}

TEST_F(RecordedTrialsTest, CorrectionsBesideTheRecording_Count) {
  RecordProperty("requirement", "SWAY-3");
  const std::string file = recording(0.0);
  const std::string session = record::xdf_test::floor_session().session_id;
  record::Corrections corrections{.session_id = session};
  corrections.add({.field = record::CorrectedField::Subject, .old_value = "P017", .new_value = "P018"});
  corrections.add(
      {.field = record::CorrectedField::Outcome, .part = 1, .trial = 2, .attempt = 1, .old_value = "done", .new_value = "rejected"});
  ASSERT_TRUE(record::write_corrections(record::corrections_file(file, session), corrections));

  ASSERT_EQ(run_with({"sway", file, "--json"}), cli::kOk) << talk();
  ASSERT_EQ(json().at("trials").size(), 1U);
  EXPECT_EQ(json().at("trials").at(0).at("subject"), "P018");
  EXPECT_EQ(json().at("trials").at(0).at("trial"), 1);

  std::ofstream(record::corrections_file(file, session)) << "{";
  EXPECT_EQ(run_with({"sway", file}), cli::exit_status(core::ErrorCode::DataDamaged)) << talk();
}

TEST_F(RecordedTrialsTest, TrialThatAGapDivides_IsMeasuredInItsLongestStretch) {
  RecordProperty("requirement", "SWAY-5");
  using namespace record::xdf_test;
  auto writer = record::XdfWriter::create(path("divided.xdf"), to_facts(floor_session())).value();
  const auto raw = writer->add_stream(regular_stream("floor/raw", {"w1_v"}, rate_of(100)));
  const auto cop = writer->add_stream(regular_stream("floor/cop", {"ml_mm", "ap_mm"}, rate_of(100)));
  const auto events = writer->add_stream(events_stream());
  const auto write = [&](std::uint32_t segment, std::uint64_t origin, std::uint64_t scans, std::vector<v1::Event> all) {
    std::vector<double> values;
    for (std::uint64_t scan = origin; scan < origin + scans; ++scan) values.insert(values.end(), {ml_mm(scan), ap_mm(scan)});
    const double begin_s = 1000.0 + 0.01 * static_cast<double>(origin);
    std::vector<std::pair<double, std::string>> texts;
    for (v1::Event& event : all) {
      event.set_segment(segment);
      texts.emplace_back(begin_s + 0.01 * static_cast<double>(event.scan()), wire::to_json(event));
    }
    const record::XdfWriter::Position start{.segment = segment, .first_scan = {0}};
    EXPECT_TRUE(writer->write_texts(events, texts, start));
    EXPECT_TRUE(writer->write_samples(raw, begin_s, std::vector<double>(scans, 0.0), start));
    EXPECT_TRUE(writer->write_samples(cop, begin_s, values, start));
  };
  write(0, 0, 300, {event_of("segment_start {}"), step(TrialEventKind::Measure, 1, "open", 100)});
  write(1, 500, 2500,
        {event_of("segment_start { reason: GAP_REASON_OVERRUN missing_scans: 200 }"), step(TrialEventKind::Done, 1, "open", 2400)});
  ASSERT_TRUE(writer->close());

  ASSERT_EQ(run_with({"sway", path("divided.xdf"), "--json"}), cli::kOk) << talk();
  ASSERT_EQ(json().at("trials").size(), 1U);
  EXPECT_EQ(json().at("trials").at(0).at("n"), 2400);
  EXPECT_EQ(json().at("trials").at(0).at("missing"), 200);
}

TEST_F(RecordedTrialsTest, ResultThatIsNotWhatIsComputed_ExitsWithOne) {
  EXPECT_EQ(run_with({"sway", recording(0.01)}), cli::kFailed) << talk();
  EXPECT_THAT(out(), HasSubstr("2 live results in the recording: 1 differ from the recomputed values"));
}

TEST_F(RecordedTrialsTest, TwoTrialsOfOneRecording_MakeARombergTest) {
  ASSERT_EQ(run_with({"sway", recording(0.0), "--compare", "--json"}), cli::kOk) << talk();

  EXPECT_TRUE(json().at("comparison").at("romberg").contains("MVELO"));
  EXPECT_EQ(json().at("first").at("trial"), 1);
}

}  // namespace
}  // namespace dts::lab::sway
