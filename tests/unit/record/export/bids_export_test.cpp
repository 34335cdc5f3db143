// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <nlohmann/json.hpp>

#include "core/utc_text.h"
#include "export_fixture.h"
#include "record/export/bids_documents.h"

namespace dts::record {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kStem = "sub-P017/ses-20261121T144525Zfloor1/motion/sub-P017_ses-20261121T144525Zfloor1_task-quietstanding_tracksys-";

class BidsExportTest : public ExportTest {
 protected:
  FakeRecording recording_ = floor_recording();
  [[nodiscard]] core::Result<Exported> run(const Progress& progress = {}) { return export_bids(recording_, folder_.string(), progress); }
  [[nodiscard]] nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(text(name)); }
};

TEST_F(BidsExportTest, Session_BecomesADatasetWithTheNamesOfTheSpecification) {
  const auto exported = run();

  ASSERT_TRUE(exported.has_value()) << exported.error().what;
  EXPECT_THAT(files(), ElementsAre("README", "dataset_description.json", "participants.json", "participants.tsv",
                                   "sourcedata/sub-P017/20261121T144525Z-floor-1_recording.json", kStem + "floorcop_channels.json",
                                   kStem + "floorcop_channels.tsv", kStem + "floorcop_events.json", kStem + "floorcop_events.tsv",
                                   kStem + "floorcop_motion.json", kStem + "floorcop_motion.tsv", kStem + "floorraw_channels.json",
                                   kStem + "floorraw_channels.tsv", kStem + "floorraw_motion.json", kStem + "floorraw_motion.tsv",
                                   "sub-P017/ses-20261121T144525Zfloor1/sub-P017_ses-20261121T144525Zfloor1_scans.tsv"));
  EXPECT_EQ(json("dataset_description.json").dump(),
            "{\"BIDSVersion\":\"1.9.0\",\"DatasetType\":\"raw\",\"GeneratedBy\":[{\"Description\":\"Recordings of distributive tactile "
            "sensing plates\",\"Name\":\"dtsd\",\"Version\":\"0.1.0\"}],\"Name\":\"Distributive tactile sensing recordings\"}");
  EXPECT_THAT(lines("participants.tsv"), ElementsAre("participant_id\tpseudonym", "sub-P017\tP-017"));
}

TEST_F(BidsExportTest, Samples_HaveNoHeaderAndBeginWithTheLatency) {
  std::get<RecordedScans>(recording_.items[3]).values[0] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(lines(kStem + "floorcop_motion.tsv"),
              ElementsAre("0.000000\tn/a\t0.1\t0.2", "0.010000\t0.3\t0.4\t0.5", "0.020000\t0.6\t0.7\t0.8", "0.030000\t0\t0.1\t0.2",
                          "0.040000\t0.3\t0.4\t0.5", "1.050000\t0\t0.1\t0.2", "1.060000\t0.3\t0.4\t0.5"));
}

TEST_F(BidsExportTest, SessionWithoutAPseudonym_IsUnknownAndTheReadmeWarnsOfTakingThemForOnePerson) {
  recording_.facts->subject.clear();
  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(lines("participants.tsv"), ElementsAre("participant_id\tpseudonym", "sub-unknown\tn/a"));
  EXPECT_THAT(text("README"), HasSubstr("sub-unknown holds the sessions that were recorded without one"));
}

TEST_F(BidsExportTest, Channels_AsManyRowsAsColumnsWithTheRequiredColumnsFirst) {
  recording_.infos[0].channels[0].device_channel = 0;
  recording_.infos[0].channels[0].is_sensor = true;
  recording_.infos[0].channels[1].is_marker = true;
  ASSERT_TRUE(run().has_value());

  EXPECT_EQ(text(kStem + "floorraw_channels.tsv"),
            "name\tcomponent\ttype\ttracked_point\tunits\tsampling_frequency\tdescription\tstatus\treference_frame\n"
            "latency\tn/a\tLATENCY\tn/a\ts\t100\tsince the first scan of the recording\tn/a\tn/a\n"
            "w1_v\tn/a\tMISC\tn/a\tV\t100\tdevice channel 0, displacement sensor\tn/a\tn/a\n"
            "w2_v\tn/a\tMISC\tn/a\tV\t100\tmarker channel\tn/a\tn/a\n");
  EXPECT_EQ(text(kStem + "floorcop_channels.tsv"),
            "name\tcomponent\ttype\ttracked_point\tunits\tsampling_frequency\tdescription\tstatus\treference_frame\n"
            "latency\tn/a\tLATENCY\tn/a\ts\t100\tsince the first scan of the recording\tn/a\tn/a\n"
            "ml_mm\tx\tPOS\tcop\tmm\t100\tn/a\tn/a\tplate\n"
            "ap_mm\ty\tPOS\tcop\tmm\t100\tn/a\tn/a\tplate\n"
            "load_n\tn/a\tMISC\tn/a\tN\t100\tn/a\tn/a\tn/a\n");
  EXPECT_EQ(lines(kStem + "floorcop_channels.tsv").size() - 1, cells(lines(kStem + "floorcop_motion.tsv").front(), '\t').size());
  EXPECT_EQ(json(kStem + "floorcop_channels.json").at("reference_frame").at("Levels").at("plate").at("SpatialAxes"), "RAI");
}

TEST_F(BidsExportTest, Sidecar_HasTheRequiredFieldsAndCountsOfEveryType) {
  recording_.facts->fields = {{"arm_length_cm", "71"}};
  recording_.damaged = "torn";
  ASSERT_TRUE(run().has_value());

  EXPECT_EQ(
      json(kStem + "floorcop_motion.json").dump(),
      "{\"DeviceSerialNumber\":\"SIM0001\",\"LATENCYChannelCount\":1,\"MISCChannelCount\":1,\"MissingValues\":\"n/"
      "a\",\"MotionChannelCount\":4,\"POSChannelCount\":2,\"RecordingDuration\":1.07,\"SamplingFrequency\":100.0,\"SoftwareVersions\":"
      "\"dtsd 0.1.0\",\"TaskName\":\"quiet-standing\",\"TrackedPointsCount\":1,\"TrackingSystemName\":\"floorcop\"}")
      << "of our own keys, BIDS validators refuse any";
  EXPECT_EQ(json("sourcedata/sub-P017/20261121T144525Z-floor-1_recording.json").at("damage"), "torn");
}

TEST_F(BidsExportTest, Events_HaveOnsetDurationAndType) {
  recording_.items.emplace_back(
      TimedEvent{.time_s = 8123.261, .event = test::event_of("scan: 1 trial { step: TRIAL_EVENT_KIND_GO condition: '120\\t%' }")});
  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(lines(kStem + "floorcop_events.tsv"),
              ElementsAre("onset\tduration\ttrial_type\tvalue\tcondition\tsegment\tscan\tdetails",
                          "0.000000\tn/a\tsegment\tn/a\tn/a\t0\t0\t{\"host_time_ns\":\"8123251000000\"}",
                          "0.010000\tn/a\ttrial\tgo\t120 %\t0\t1\t{\"condition\":\"120\\t%\"}",
                          "0.020000\t0\tmarker\teyes \"closed\", now\tn/a\t0\t2\tn/a",
                          "1.050000\tn/a\tsegment\tunplugged\tn/a\t1\t0\t{\"missing_scans\":\"100\"}"));
}

TEST_F(BidsExportTest, Scans_SayWhenTheRecordingBegan) {
  ASSERT_TRUE(run().has_value());

  const auto rows = lines("sub-P017/ses-20261121T144525Zfloor1/sub-P017_ses-20261121T144525Zfloor1_scans.tsv");
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0], "filename\tacq_time");
  for (std::size_t row = 1; row < rows.size(); ++row) {
    const auto row_cells = cells(rows[row], '\t');
    EXPECT_TRUE(std::filesystem::exists(folder_ / "sub-P017/ses-20261121T144525Zfloor1" / row_cells[0])) << rows[row];
    EXPECT_EQ(row_cells[1], core::utc_text(1'795'272'000'000'000'000 + 8'123'251'000'000));
  }
}

TEST_F(BidsExportTest, LabelSomebodyTyped_IsNowhere) {
  ASSERT_TRUE(run().has_value());

  for (const std::string& file : files()) {
    EXPECT_THAT(file, Not(HasSubstr("Jane")));
    EXPECT_THAT(text(file), Not(HasSubstr("Jane"))) << file;
  }
}

TEST_F(BidsExportTest, SecondSubjectAndSecondPart_AreAddedToTheDataset) {
  ASSERT_TRUE(run().has_value());
  recording_.facts->part = 2;
  ASSERT_TRUE(run().has_value());
  recording_.facts->subject = "P-018";
  recording_.facts->part = 1;

  const auto exported = run();

  ASSERT_TRUE(exported.has_value()) << exported.error().what;
  EXPECT_THAT(files(), Contains(kStem + "floorcop_run-2_motion.tsv"));
  EXPECT_THAT(lines("participants.tsv"), ElementsAre("participant_id\tpseudonym", "sub-P017\tP-017", "sub-P018\tP-018"));
  EXPECT_EQ(lines("sub-P017/ses-20261121T144525Zfloor1/sub-P017_ses-20261121T144525Zfloor1_scans.tsv").size(), 5U);
}

TEST_F(BidsExportTest, TheSameAgain_WrongStateAndTheDatasetStaysAsItWas) {
  ASSERT_TRUE(run().has_value());
  const auto before = files();

  EXPECT_EQ(refusal(run()),
            "'/out/sub-P017/ses-20261121T144525Zfloor1/motion/"
            "sub-P017_ses-20261121T144525Zfloor1_task-quietstanding_tracksys-floorraw_motion.tsv' exists already: an export never "
            "overwrites a file (choose another folder, or move it away)");
  EXPECT_EQ(files(), before);
  EXPECT_EQ(lines("participants.tsv").size(), 2U);
}

TEST_F(BidsExportTest, PseudonymsThatBecomeOneLabel_AreToldNotMixed) {
  ASSERT_TRUE(run().has_value());
  recording_.facts->subject = "P017";
  recording_.facts->session_id = "another";

  EXPECT_EQ(refusal(run()),
            "another subject ID of this data set becomes sub-P017 too: BIDS allows only letters and digits, and many disks ignore the "
            "difference of upper and lower case (export into a new folder)");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sub-P017/ses-another"));
}

TEST_F(BidsExportTest, SubjectsThatDifferOnlyInCase_AreToldNotMixed) {
  recording_.facts->subject = "P1";
  ASSERT_TRUE(run().has_value());
  recording_.facts->subject = "p1";
  recording_.facts->session_id = "another";

  EXPECT_EQ(refusal(run()),
            "another subject ID of this data set becomes sub-p1 too: BIDS allows only letters and digits, and many disks ignore the "
            "difference of upper and lower case (export into a new folder)");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sub-p1"));
}

TEST_F(BidsExportTest, FolderOfSomethingElse_IsLeftAlone) {
  write("holiday.txt", "mine");
  EXPECT_EQ(refusal(run()), "'/out' contains files that are not a BIDS data set (choose a new folder, or an empty one)");
  EXPECT_THAT(files(), ElementsAre("holiday.txt"));

  write("dataset_description.json", R"({"Name": "of somebody else", "BIDSVersion": "1.9.0"})");
  EXPECT_EQ(refusal(run()), "'/out/dataset_description.json' belongs to a data set that dtsd did not write (choose another folder)");
  EXPECT_THAT(files(), ElementsAre("dataset_description.json", "holiday.txt"));
}

TEST_F(BidsExportTest, Stopped_LeavesNothing) {
  EXPECT_EQ(refusal(run([](std::uint64_t, std::uint64_t) { return false; })), "stopped: nothing of this recording was exported");
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(BidsExportTest, NoSubjectAndForeignFile_HaveLabelsAllTheSame) {
  recording_.facts.reset();
  for (StreamInfo& info : recording_.infos) info.name = "../x";

  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(files(), Contains("sub-unknown/ses-unknown/motion/sub-unknown_ses-unknown_task-free_tracksys-x2_motion.tsv"));
  EXPECT_THAT(lines("participants.tsv"), ElementsAre("participant_id\tpseudonym", "sub-unknown\tn/a"));
}

TEST_F(BidsExportTest, RecordingWithoutScans_SaysSo) {
  recording_.items.resize(1);

  EXPECT_EQ(refusal(run()), "the recording has no scans: BIDS needs scans (export it as CSV)");
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

TEST_F(BidsExportTest, ACorrectedSubject_IsTheParticipant_AndFreeTextsStayOut) {
  Corrections corrections{.session_id = recording_.facts->session_id};
  corrections.add({.who = "local:anna", .field = CorrectedField::Subject, .old_value = "P-017", .new_value = "P-018", .reason = "Jane"});
  corrections.add({.who = "local", .field = CorrectedField::Label, .old_value = "Jane Doe", .new_value = "Jane", .reason = "Jane"});
  ASSERT_TRUE(export_bids(recording_, folder_.string(), {}, corrections));
  EXPECT_THAT(text("participants.tsv"), ::testing::HasSubstr("sub-P018\tP-018"));
  const std::string document = text("sourcedata/sub-P018/" + recording_.facts->session_id + "_recording.json");
  EXPECT_THAT(document, ::testing::HasSubstr("\"recorded_subject\": \"P-017\""));
  for (const char* secret : {"Jane", "anna"}) EXPECT_EQ(document.find(secret), std::string::npos) << secret;
}

}  // namespace
}  // namespace dts::record
