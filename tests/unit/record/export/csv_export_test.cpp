// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <limits>
#include <nlohmann/json.hpp>

#include "export_fixture.h"
#include "record/export/event_rows.h"

namespace dts::record {
namespace {

using ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::size_t kBlocks = 2000;

/// 200,000 scans of two streams.
FakeRecording long_recording() {
  FakeRecording recording = floor_recording();
  recording.items.clear();
  for (std::uint64_t block = 0; block < kBlocks; ++block) {
    const double time_s = 1.0 + static_cast<double>(block);
    recording.items.emplace_back(RecordedScans{.stream = 0,
                                               .segment = 0,
                                               .first_scan = {block * 100},
                                               .first_time_s = time_s,
                                               .count = 100,
                                               .values = std::vector<double>(200, 0.25)});
    recording.items.emplace_back(RecordedScans{.stream = 1,
                                               .segment = 0,
                                               .first_scan = {block * 100},
                                               .first_time_s = time_s,
                                               .count = 100,
                                               .values = std::vector<double>(300, 0.5)});
  }
  return recording;
}

class CsvExportTest : public ExportTest {
 protected:
  FakeRecording recording_ = floor_recording();
  [[nodiscard]] core::Result<Exported> run(const Progress& progress = {}) { return export_csv(recording_, folder_.string(), progress); }
};

TEST_F(CsvExportTest, Session_OneFilePerStreamAndTheEvents) {
  const auto exported = run();

  ASSERT_TRUE(exported.has_value()) << exported.error().what;
  EXPECT_EQ(exported->rows, 7U + 7U + 2U + 3U);
  std::uint64_t bytes = 0;
  for (const std::string& file : exported->files) bytes += std::filesystem::file_size(file);
  EXPECT_EQ(exported->bytes, bytes);
  EXPECT_THAT(files(),
              ElementsAre("20261121T144525Z-floor-1_cop.csv", "20261121T144525Z-floor-1_events.csv", "20261121T144525Z-floor-1_quality.csv",
                          "20261121T144525Z-floor-1_raw.csv", "20261121T144525Z-floor-1_recording.json"));
  EXPECT_EQ(exported->files.size(), 5U);
  EXPECT_EQ(text("20261121T144525Z-floor-1_cop.csv"),
            "t_s,segment,scan,ml_mm,ap_mm,load_n\n"
            "0,0,0,0,0.1,0.2\n"
            "0.01,0,1,0.3,0.4,0.5\n"
            "0.02,0,2,0.6,0.7,0.8\n"
            "0.03,0,3,0,0.1,0.2\n"
            "0.04,0,4,0.3,0.4,0.5\n"
            "1.05,1,0,0,0.1,0.2\n"
            "1.06,1,1,0.3,0.4,0.5\n");
  EXPECT_EQ(text("20261121T144525Z-floor-1_raw.csv"),
            "t_s,segment,scan,w1_v,w2_v\n"
            "0,0,0,0,0.10000000149011612\n"
            "0.01,0,1,0.20000000298023224,0.30000001192092896\n"
            "0.02,0,2,0.4000000059604645,0.5\n"
            "0.03,0,3,0,0.10000000149011612\n"
            "0.04,0,4,0.20000000298023224,0.30000001192092896\n"
            "1.05,1,0,0,0.10000000149011612\n"
            "1.06,1,1,0.20000000298023224,0.30000001192092896\n");
  EXPECT_EQ(text("20261121T144525Z-floor-1_quality.csv"),
            "t_s,segment,scan,w1_v\n"
            "0,0,0,0\n"
            "1.06,1,1,8\n");
  EXPECT_EQ(text("20261121T144525Z-floor-1_events.csv"),
            "t_s,segment,scan,event,text,details\n"
            "0,0,0,segment,,\"{\"\"host_time_ns\"\":\"\"8123251000000\"\"}\"\n"
            "0.02,0,2,marker,\"eyes \"\"closed\"\", now\",\n"
            "1.05,1,0,segment,unplugged,\"{\"\"missing_scans\"\":\"\"100\"\"}\"\n")
      << "text and details are quoted as CSV asks for";
}

TEST_F(CsvExportTest, Events_AreSortedByTime_AlsoAfterAnUndo) {
  const auto step = [](double time_s, const std::string& position, const std::string& step_of_trial) {
    return TimedEvent{.time_s = time_s,
                      .event = test::event_of(position + " trial { step: TRIAL_EVENT_KIND_" + step_of_trial + " trial: 1 attempt: 1 }")};
  };
  for (const TimedEvent& event : {step(8123.251, "scan: 0", "MEASURE"), step(8123.281, "scan: 3", "REJECTED"),
                                  step(8124.311, "segment: 1 scan: 1", "UNDONE"), step(8123.291, "scan: 4", "DONE")})
    recording_.items.emplace_back(event);
  ASSERT_TRUE(run().has_value());

  std::vector<std::string> order;
  for (const std::string& row : lines("20261121T144525Z-floor-1_events.csv")) {
    const auto columns = cells(row, ',');
    order.push_back(columns[0] + " " + columns[3] + " " + columns[4]);
  }
  order.erase(order.begin());
  EXPECT_EQ(order[0], "0 segment ") << "rows of the same time stay as recorded";
  EXPECT_THAT(order, ElementsAre("0 segment ", "0 trial measure", "0.02 marker \"eyes \"\"closed\"\"", "0.03 trial rejected",
                                 "0.04 trial done", "1.05 segment unplugged", "1.06 trial undone"));
}

TEST_F(CsvExportTest, MoreEventsThanAreSorted_AreAllThere) {
  constexpr std::size_t kEvents = EventRows::kMostWaiting + 100;
  for (std::size_t n = 0; n < kEvents; ++n) {
    const double time_s = 8200.0 + static_cast<double>(n % 2 == 0 ? n + 1 : n - 1);
    recording_.items.emplace_back(TimedEvent{.time_s = time_s, .event = test::event_of("marker { text: 'x' }")});
  }
  ASSERT_TRUE(run().has_value());

  const auto rows = lines("20261121T144525Z-floor-1_events.csv");
  ASSERT_EQ(rows.size(), 1 + 3 + kEvents);
  double newest_s = -1.0;
  for (std::size_t row = 1; row < rows.size(); ++row) {
    const double time_s = std::stod(rows[row]);
    EXPECT_GE(time_s, newest_s);
    newest_s = time_s;
  }
}

TEST_F(CsvExportTest, RecordingDocument_SaysWhatIsMissingAndWhatWasAskedAboutTheSubject) {
  recording_.facts->fields = {{"arm_length_cm", "71"}};
  ASSERT_TRUE(run().has_value());

  EXPECT_EQ(nlohmann::json::parse(text("20261121T144525Z-floor-1_recording.json")).dump(),
            "{\"device_serial\":\"SIM0001\",\"duration_s\":0.0,\"gaps\":1,\"kind\":\"floor\",\"label\":\"Jane "
            "Doe\",\"losses\":{\"unplugged\":{\"gaps\":1,\"scans\":100}},\"lost_scans\":100,\"part\":1,\"protocol\":\"quiet-standing\","
            "\"rig\":\"floor\",\"session_id\":\"20261121T144525Z-floor-1\",\"software\":\"dtsd "
            "0.1.0\",\"started_utc\":\"2026-11-21T14:45:25.000000Z\",\"streams\":[{\"channels\":[{\"label\":\"w1_v\",\"unit\":\"V\"},{"
            "\"label\":\"w2_v\",\"unit\":\"V\"}],\"filter_delay_s\":0.0,\"name\":\"floor/"
            "raw\",\"rate_hz\":100.0,\"samples\":7},{\"channels\":[{\"label\":\"ml_mm\",\"unit\":\"mm\"},{\"label\":\"ap_mm\",\"unit\":"
            "\"mm\"},{\"label\":\"load_n\",\"unit\":\"N\"}],\"filter_delay_s\":0.0,\"name\":\"floor/"
            "cop\",\"rate_hz\":100.0,\"samples\":7},{\"channels\":[{\"label\":\"event\",\"unit\":\"\"}],\"filter_delay_s\":0.0,\"name\":"
            "\"floor/events\",\"samples\":0},{\"channels\":[{\"label\":\"w1_v\",\"unit\":\"\"}],\"filter_delay_s\":0.0,\"name\":\"floor/"
            "quality\",\"samples\":2}],\"subject\":\"P-017\",\"subject_fields\":{\"arm_length_cm\":\"71\"}}");
}

TEST_F(CsvExportTest, Trials_HaveATableOfTheirOwn) {
  const auto step = [](const std::string& position, const std::string& step_of_trial) {
    return TimedEvent{
        .time_s = 0.0,
        .event = test::event_of(position + " trial { step: TRIAL_EVENT_KIND_" + step_of_trial + " attempt: 1 condition: '=eyes' }")};
  };
  for (const TimedEvent& event :
       {step("scan: 1", "MEASURE trial: 1"), step("scan: 3", "DONE trial: 1"), step("segment: 1", "MEASURE trial: 2")})
    recording_.items.emplace_back(event);
  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(lines("20261121T144525Z-floor-1_trials.csv"),
              ElementsAre("trial,attempt,block,condition,outcome,is_valid,first_segment,first_scan,last_segment,last_scan,fault",
                          "1,1,1,'=eyes,done,1,0,1,0,3,", "2,1,1,'=eyes,aborted,0,1,0,1,1,"));
}

TEST_F(CsvExportTest, Trials_HaveTheMeasuresOfTheirResults) {
  for (const std::string text : {"scan: 1 trial { step: TRIAL_EVENT_KIND_MEASURE trial: 1 attempt: 1 condition: 'open' }",
                                 "scan: 3 trial { step: TRIAL_EVENT_KIND_DONE trial: 1 attempt: 1 condition: 'open' }",
                                 "scan: 4 trial { step: TRIAL_EVENT_KIND_MEASURE trial: 2 attempt: 1 condition: 'shut' }",
                                 "scan: 6 trial { step: TRIAL_EVENT_KIND_DONE trial: 2 attempt: 1 condition: 'shut' }",
                                 "scan: 6 sway { trial: 1 attempt: 1 is_valid: true duration_s: 20 measures { symbol: 'MVELO' value: 8.25 "
                                 "unit: 'mm/s' } measures { symbol: 'RDIST' value: 5.5 unit: 'mm' } }",
                                 "scan: 7 sway { trial: 2 attempt: 1 is_valid: false flags: 2048 duration_s: 20 measures { symbol: 'MVELO' "
                                 "value: 9 unit: 'mm/s' } }"}) {
    recording_.items.emplace_back(TimedEvent{.time_s = 0.0, .event = test::event_of(text)});
  }
  ASSERT_TRUE(run().has_value());

  const std::string place = "first_segment,first_scan,last_segment,last_scan";
  EXPECT_THAT(lines("20261121T144525Z-floor-1_trials.csv"),
              ElementsAre("trial,attempt,block,condition,outcome,is_valid," + place + ",fault,duration_s,MVELO [mm/s],RDIST [mm]",
                          "1,1,1,open,done,1,0,1,0,3,,20,8.25,5.5", "2,1,1,shut,done,0,0,4,0,6,stepped_off,20,9,"));
}

TEST_F(CsvExportTest, TrialWithoutADecision_HasItsReasonAndNoProbability) {
  const std::string facts =
      "label: 'group60' people: 124 auc: 0.5 auc_low: 0.25 auc_high: 0.75 best_measure: 'MVELO' best_measure_auc: 0.5 "
      "probabilities { group: '60plus' probability: 0.25 } probabilities { group: 'under60' probability: 0.75 }";
  for (const std::string& text :
       {std::string("scan: 1 trial { step: TRIAL_EVENT_KIND_MEASURE trial: 1 attempt: 1 condition: 'a' }"),
        std::string("scan: 3 trial { step: TRIAL_EVENT_KIND_DONE trial: 1 attempt: 1 condition: 'a' }"),
        std::string("scan: 4 trial { step: TRIAL_EVENT_KIND_MEASURE trial: 2 attempt: 1 condition: 'a' }"),
        std::string("scan: 6 trial { step: TRIAL_EVENT_KIND_DONE trial: 2 attempt: 1 condition: 'a' }"),
        "scan: 6 sway { trial: 1 attempt: 1 is_valid: true decision { outcome: DECISION_OUTCOME_DECIDED group: 'under60' " + facts + " } }",
        "scan: 7 sway { trial: 2 attempt: 1 is_valid: true decision { outcome: DECISION_OUTCOME_NOT_COMPARABLE group: 'under60' " + facts +
            " } }"}) {
    recording_.items.emplace_back(TimedEvent{.time_s = 0.0, .event = test::event_of(text)});
  }
  ASSERT_TRUE(run().has_value());

  const std::string place = "first_segment,first_scan,last_segment,last_scan";
  const std::string of_model = "group60,124,,0.5,0.25,0.75,MVELO,0.5,,No statement about health or risk of falling.";
  const std::string header = "trial,attempt,block,condition,outcome,is_valid," + place + ",fault,decision,p_60plus [1],p_under60 [1]," +
                             "model,model_people,model_condition,model_auc [1],model_auc_low [1],model_auc_high [1]," +
                             "best_measure,best_measure_auc [1],rival,decision_limit";
  EXPECT_THAT(lines("20261121T144525Z-floor-1_trials.csv"), ElementsAre(header, "1,1,1,a,done,1,0,1,0,3,,decided,0.25,0.75," + of_model,
                                                                        "2,1,1,a,done,1,0,4,0,6,,not comparable,,," + of_model));
}

const Correction kFirstTrialRejected{.who = "local",
                                     .field = CorrectedField::Outcome,
                                     .part = 1,
                                     .trial = 1,
                                     .attempt = 1,
                                     .old_value = "done",
                                     .new_value = "rejected",
                                     .reason = "r"};

TEST_F(CsvExportTest, WithdrawnTrial_HasNoDecision) {
  for (const char* text :
       {"scan: 1 trial { step: TRIAL_EVENT_KIND_MEASURE trial: 1 attempt: 1 condition: 'a' }",
        "scan: 3 trial { step: TRIAL_EVENT_KIND_DONE trial: 1 attempt: 1 condition: 'a' }",
        "scan: 3 sway { trial: 1 attempt: 1 is_valid: true decision { outcome: DECISION_OUTCOME_DECIDED group: 'under60' } }"}) {
    recording_.items.emplace_back(TimedEvent{.time_s = 0.0, .event = test::event_of(text)});
  }
  Corrections corrections{.session_id = recording_.facts->session_id};
  corrections.add(kFirstTrialRejected);
  ASSERT_TRUE(export_csv(recording_, folder_.string(), {}, corrections));
  EXPECT_THAT(text("20261121T144525Z-floor-1_trials.csv"), Not(HasSubstr("decision")));
}

TEST_F(CsvExportTest, CorrectedValues_StandBesideTheRecordedOnes) {
  const auto step = [](const std::string& position, const std::string& step_of_trial) {
    return TimedEvent{
        .time_s = 0.0,
        .event = test::event_of(position + " trial { step: TRIAL_EVENT_KIND_" + step_of_trial + " attempt: 1 condition: 'a' }")};
  };
  for (const TimedEvent& event : {step("scan: 1", "MEASURE trial: 1"), step("scan: 3", "DONE trial: 1")})
    recording_.items.emplace_back(event);
  Corrections corrections{.session_id = recording_.facts->session_id};
  corrections.add({.who = "local:anna", .field = CorrectedField::Subject, .old_value = "P-017", .new_value = "P-018", .reason = "=cmd"});
  corrections.add({.who = "local", .field = CorrectedField::Notes, .old_value = "", .new_value = "<b>n</b>", .reason = "r"});
  corrections.add(kFirstTrialRejected);
  ASSERT_TRUE(export_csv(recording_, folder_.string(), {}, corrections));

  EXPECT_THAT(
      lines("20261121T144525Z-floor-1_trials.csv"),
      ElementsAre("trial,attempt,block,condition,outcome,is_valid,first_segment,first_scan,last_segment,last_scan,recorded_outcome,fault",
                  "1,1,1,a,rejected,0,0,1,0,3,done,"));
  const auto document = nlohmann::json::parse(text("20261121T144525Z-floor-1_recording.json"));
  EXPECT_EQ(document["subject"], "P-018");
  EXPECT_EQ(document["recorded_subject"], "P-017");
  EXPECT_EQ(document["notes"], "<b>n</b>");
  ASSERT_EQ(document["corrections"].size(), 3U);
  EXPECT_EQ(document["corrections"][0]["reason"], "=cmd");
  EXPECT_EQ(document["corrections"][2]["old_value"], "done");
}

TEST_F(CsvExportTest, ALabelThatWasRemoved_IsNotExportedAsRecorded) {
  recording_.facts->label = "Jane Doe";
  Corrections corrections{.session_id = recording_.facts->session_id};
  const auto exported = [&](const std::string& from, const std::string& to) {
    corrections.add({.who = "local", .field = CorrectedField::Label, .old_value = from, .new_value = to, .reason = "r"});
    std::filesystem::remove_all(folder_);  // an export replaces no file
    EXPECT_TRUE(export_csv(recording_, folder_.string(), {}, corrections));
    return text("20261121T144525Z-floor-1_recording.json");
  };
  EXPECT_THAT(exported("Jane Doe", "first"), HasSubstr("\"recorded_label\": \"Jane Doe\""));
  EXPECT_THAT(exported("first", ""), Not(HasSubstr("Jane")));
  const std::string again = exported("", "second");
  EXPECT_THAT(again, HasSubstr("\"label\": \"second\""));
  EXPECT_THAT(again, Not(HasSubstr("Jane")));
}

TEST_F(CsvExportTest, AMarkerHasItsCorrectedText_AndARemovedOneNone) {
  recording_.items.emplace_back(TimedEvent{.time_s = 8125.0, .event = test::event_of("scan: 9 marker { text: 'cough' }")});
  Corrections corrections{.session_id = recording_.facts->session_id};
  const auto correct = [&](std::uint32_t marker, const std::string& from, const std::string& to) {
    corrections.add(
        {.who = "local", .field = CorrectedField::Marker, .part = 1, .marker = marker, .old_value = from, .new_value = to, .reason = "r"});
  };
  correct(1, "eyes \"closed\", now", "eyes shut");
  correct(2, "cough", "Xavier");
  correct(2, "Xavier", "");
  ASSERT_TRUE(export_csv(recording_, folder_.string(), {}, corrections));

  const std::string events = text("20261121T144525Z-floor-1_events.csv");
  EXPECT_THAT(events, HasSubstr("0.02,0,2,marker,eyes shut,\n"));
  EXPECT_THAT(events, HasSubstr("0,9,marker,,\n"));
  const std::string document = text("20261121T144525Z-floor-1_recording.json");
  EXPECT_EQ(nlohmann::json::parse(document)["corrections"][0]["old_value"], "eyes \"closed\", now");
  EXPECT_EQ(nlohmann::json::parse(document)["corrections"][2]["marker"], 2);
  EXPECT_THAT(events + document, Not(AnyOf(HasSubstr("Xavier"), HasSubstr("cough"))));
}

TEST_F(CsvExportTest, EveryNumber_ReadsBackAsExactlyTheRecordedOne) {
  RecordProperty("requirement", "REP-4");
  const std::vector<double> hard{0.1,           1.0 / 3.0, -2.5e-308,         5e-324, 1.7976931348623157e308,
                                 123456789.125, -0.0,      65504.0 / 32768.0, 1e21,   9.999999999999999e22};
  recording_.infos = {recording_.infos[0], recording_.infos[1]};
  recording_.items.clear();
  RecordedScans doubles{.stream = 0, .segment = 0, .first_scan = {0}, .first_time_s = 5.0, .count = hard.size() / 2, .values = hard};
  RecordedScans floats{.stream = 1, .segment = 0, .first_scan = {0}, .first_time_s = 5.0, .count = 1, .values = {}};
  for (const float value : {0.1F, 1.17549435e-38F, 3.40282347e38F}) floats.values.push_back(static_cast<double>(value));
  recording_.items = {doubles, floats};

  ASSERT_TRUE(run().has_value());

  const auto rows = lines("20261121T144525Z-floor-1_raw.csv");
  ASSERT_EQ(rows.size(), 1 + hard.size() / 2);
  for (std::size_t value = 0; value < hard.size(); ++value) {
    const std::string cell = cells(rows[1 + value / 2], ',')[3 + value % 2];
    const double read = std::strtod(cell.c_str(), nullptr);
    EXPECT_EQ(std::signbit(read), std::signbit(hard[value])) << cell;
    EXPECT_EQ(read, hard[value]) << cell;
  }
  const auto row = cells(lines("20261121T144525Z-floor-1_cop.csv")[1], ',');
  EXPECT_EQ(std::strtof(row[3].c_str(), nullptr), 0.1F);
  EXPECT_EQ(std::strtof(row[4].c_str(), nullptr), 1.17549435e-38F);
  EXPECT_EQ(std::strtof(row[5].c_str(), nullptr), 3.40282347e38F);
}

TEST_F(CsvExportTest, UndefinedValue_IsAnEmptyCell) {
  std::get<RecordedScans>(recording_.items[3]).values[0] = std::numeric_limits<double>::quiet_NaN();
  std::get<RecordedScans>(recording_.items[3]).values[2] = std::numeric_limits<double>::quiet_NaN();

  ASSERT_TRUE(run().has_value());

  EXPECT_EQ(lines("20261121T144525Z-floor-1_cop.csv")[1], "0,0,0,,0.1,");
}

TEST_F(CsvExportTest, TimesOfManyScans_FollowTheExactRateNotTheStamps) {
  recording_.infos = {recording_.infos[0]};
  recording_.infos[0].rate = *core::Rate::create(1500, 1);
  recording_.infos[0].channels.resize(1);
  recording_.items.clear();
  for (std::uint64_t block = 0; block < 100; ++block) {
    const double time_s = 8123.251 + static_cast<double>(block * 10) / 1500.0 + (block % 2 == 0 ? 3e-7 : -3e-7);  // rounded stamps
    recording_.items.emplace_back(RecordedScans{
        .stream = 0, .segment = 0, .first_scan = {block * 10}, .first_time_s = time_s, .count = 10, .values = std::vector<double>(10)});
  }

  ASSERT_TRUE(run().has_value());

  const auto rows = lines("20261121T144525Z-floor-1_raw.csv");
  EXPECT_EQ(rows[2].substr(0, rows[2].find(',')), "0.000666667");
  EXPECT_EQ(rows[751].substr(0, rows[751].find(',')), "0.5");
  EXPECT_EQ(rows[1000].substr(0, rows[1000].find(',')), "0.666");
}

TEST_F(CsvExportTest, EventBeforeTheFirstScan_HasANegativeTime) {
  std::get<TimedEvent>(recording_.items[0]).time_s -= 0.25;

  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(lines("20261121T144525Z-floor-1_events.csv")[1], ::testing::StartsWith("-0.25,0,0,segment"));
}

TEST_F(CsvExportTest, ChannelWithoutUnitInItsName_GetsIt) {
  recording_.infos[0].channels[0] = {.label = "Fz, left", .unit = "N"};

  ASSERT_TRUE(run().has_value());

  EXPECT_EQ(lines("20261121T144525Z-floor-1_raw.csv")[0], "t_s,segment,scan,\"Fz, left_n\",w2_v");
}

TEST_F(CsvExportTest, SecondPart_HasNamesOfItsOwn) {
  ASSERT_TRUE(run().has_value());
  recording_.facts->part = 2;

  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(files(), ::testing::Contains("20261121T144525Z-floor-1.2_cop.csv"));
}

TEST_F(CsvExportTest, HostileNames_StayInTheFolder) {
  recording_.facts->session_id = "../../etc/x";
  recording_.infos[0].name = "floor/..";
  recording_.infos[1].name = "../cop\n";

  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(files(), ElementsAre("_._.._etc_x__..csv", "_._.._etc_x_cop_.csv", "_._.._etc_x_events.csv", "_._.._etc_x_quality.csv",
                                   "_._.._etc_x_recording.json"));
}

TEST_F(CsvExportTest, ForeignRecordingWithEqualStreamNames_NothingIsLost) {
  recording_.facts.reset();
  for (StreamInfo& info : recording_.infos) info.name = "EEG";

  const auto exported = run();

  ASSERT_TRUE(exported.has_value());
  EXPECT_THAT(files(), ElementsAre("recording_EEG-2.csv", "recording_EEG-3.csv", "recording_EEG.csv", "recording_events.csv",
                                   "recording_recording.json"));
}

TEST_F(CsvExportTest, FileThatExists_WrongStateAndNothingIsTouched) {
  RecordProperty("requirement", "REP-7");
  write("20261121T144525Z-floor-1_events.csv", "mine");

  EXPECT_EQ(refusal(run()),
            "'/out/20261121T144525Z-floor-1_events.csv' exists already: an export never overwrites a file (choose another folder, or move "
            "it away)");
  EXPECT_THAT(files(), ElementsAre("20261121T144525Z-floor-1_events.csv"));
  EXPECT_EQ(text("20261121T144525Z-floor-1_events.csv"), "mine");
}

TEST_F(CsvExportTest, FileThatAppearsMeanwhile_IsNotOverwritten) {
  const auto intrude = [&](std::uint64_t, std::uint64_t) {
    write("20261121T144525Z-floor-1_raw.csv", "mine");
    return true;
  };

  EXPECT_EQ(
      refusal(run(intrude)),
      "'/out/20261121T144525Z-floor-1_raw.csv' exists already: an export never overwrites a file (choose another folder, or move it away)");
  EXPECT_EQ(text("20261121T144525Z-floor-1_raw.csv"), "mine");
  EXPECT_THAT(files(), ElementsAre("20261121T144525Z-floor-1_raw.csv"));
}

TEST_F(CsvExportTest, Stopped_LeavesNothingNotEvenTheFolder) {
  int calls = 0;

  const auto exported = run([&](std::uint64_t done, std::uint64_t of) {
    EXPECT_LE(done, of);
    return ++calls < 3;
  });

  ASSERT_FALSE(exported.has_value());
  EXPECT_EQ(calls, 3);
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(CsvExportTest, RecordingThatCannotBeReadOn_FailsAndLeavesNothing) {
  recording_.fails_at = 5;

  EXPECT_EQ(refusal(run()), "chunk torn");
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(CsvExportTest, AnotherExportUnderWay_WrongStateAndSaysWhatToDo) {
  write(".20261121T144525Z-floor-1_raw.csv.part", "half");

  EXPECT_EQ(refusal(run()),
            "'/out/.20261121T144525Z-floor-1_raw.csv.part' exists: another export is running, or one was killed (if no other export is "
            "running, delete that file)");
  EXPECT_THAT(files(), ElementsAre(".20261121T144525Z-floor-1_raw.csv.part"));
}

/// While it lives, no file of this process grows beyond a limit: a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    before_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit small{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, before_handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*before_handler_)(int) = nullptr;
};

TEST_F(CsvExportTest, DiskFullOnTheWayOrAtTheEnd_FailsWithTheFileAndLeavesNothing) {
  RecordProperty("requirement", "REP-7");
  recording_ = long_recording();

  for (const rlim_t bytes : {1U << 20U, 100U}) {
    const std::string refused = [&] {
      const FullDisk full(bytes);
      return refusal(run());
    }();
    EXPECT_THAT(refused, ::testing::MatchesRegex("cannot write '/out/.*csv.*: File too large.*")) << bytes;
    EXPECT_FALSE(std::filesystem::exists(folder_));
    recording_ = floor_recording();
  }
}

TEST_F(CsvExportTest, RecordingWithoutAnything_IsAnEmptyListOfEvents) {
  recording_ = {};

  const auto exported = run();

  ASSERT_TRUE(exported.has_value());
  EXPECT_THAT(files(), ElementsAre("recording_events.csv", "recording_recording.json"));
  EXPECT_EQ(exported->rows, 0U);
}

TEST_F(CsvExportTest, FolderThatCannotBeMade_FailsAndSaysWhich) {
  std::ofstream(base_ / "file") << "x";

  EXPECT_EQ(refusal(export_csv(recording_, (base_ / "file" / "below").string())),
            "cannot create the folder '/file/below': Not a directory (choose a folder that you may write into)");
}

TEST_F(CsvExportTest, LongRecording_EveryRowIsThereInOrder) {
  recording_ = long_recording();

  ASSERT_TRUE(run().has_value());

  for (const auto& [name, columns] : {std::pair{"raw", 5U}, std::pair{"cop", 6U}}) {
    const auto rows = lines(std::string("20261121T144525Z-floor-1_") + name + ".csv");
    ASSERT_EQ(rows.size(), 1 + kBlocks * 100);
    for (std::size_t scan = 0; scan < kBlocks * 100; ++scan) {
      const auto row = cells(rows[1 + scan], ',');
      ASSERT_EQ(row.size(), columns);
      ASSERT_EQ(row[2], std::to_string(scan)) << name;
    }
  }
}

}  // namespace
}  // namespace dts::record
