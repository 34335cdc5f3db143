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
  EXPECT_EQ(json("dataset_description.json").at("DatasetType"), "raw");
  EXPECT_EQ(json("dataset_description.json").at("BIDSVersion"), "1.9.0");
  EXPECT_EQ(json("dataset_description.json").at("GeneratedBy").at(0).at("Version"), "0.1.0");
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

TEST_F(BidsExportTest, Losses_AreThoseOfTheRecording) {
  ASSERT_TRUE(run().has_value());

  const auto facts = json("sourcedata/sub-P017/20261121T144525Z-floor-1_recording.json");
  EXPECT_EQ(facts.at("gaps"), 1);
  EXPECT_EQ(facts.at("lost_scans"), 100);
  EXPECT_EQ(facts.at("losses").at("unplugged").at("gaps"), 1);
}

TEST_F(BidsExportTest, Channels_AsManyRowsAsColumnsWithTheRequiredColumnsFirst) {
  recording_.infos[0].channels[0].device_channel = 0;
  recording_.infos[0].channels[0].is_sensor = true;
  recording_.infos[0].channels[1].is_marker = true;
  ASSERT_TRUE(run().has_value());

  const auto raw_rows = lines(kStem + "floorraw_channels.tsv");
  EXPECT_EQ(cells(raw_rows[2], '\t')[6], "device channel 0, displacement sensor");
  EXPECT_EQ(cells(raw_rows[3], '\t')[6], "marker channel");
  const auto rows = lines(kStem + "floorcop_channels.tsv");
  EXPECT_THAT(rows.front(), ::testing::StartsWith("name\tcomponent\ttype\ttracked_point\tunits\t"));
  ASSERT_EQ(rows.size() - 1, cells(lines(kStem + "floorcop_motion.tsv").front(), '\t').size());
  for (const std::string& row : rows) EXPECT_EQ(cells(row, '\t').size(), cells(rows.front(), '\t').size());
  EXPECT_THAT(rows[1], ::testing::StartsWith("latency\tn/a\tLATENCY\tn/a\ts\t100\t"));
  EXPECT_THAT(rows[2], ::testing::StartsWith("ml_mm\tx\tPOS\tcop\tmm\t100\t"));
  EXPECT_THAT(rows[3], ::testing::StartsWith("ap_mm\ty\tPOS\tcop\tmm\t100\t"));
  EXPECT_THAT(rows[4], ::testing::StartsWith("load_n\tn/a\tMISC\tn/a\tN\t100\t"));
  EXPECT_EQ(json(kStem + "floorcop_channels.json").at("reference_frame").at("Levels").at("plate").at("SpatialAxes"), "RAI");
}

TEST_F(BidsExportTest, Sidecar_HasTheRequiredFieldsAndCountsOfEveryType) {
  recording_.facts->fields = {{"arm_length_cm", "71"}};
  recording_.damaged = "torn";
  ASSERT_TRUE(run().has_value());

  const auto sidecar = json(kStem + "floorcop_motion.json");
  EXPECT_EQ(sidecar.at("TaskName"), "quiet-standing");
  EXPECT_EQ(sidecar.at("SamplingFrequency"), 100.0);
  EXPECT_EQ(sidecar.at("TrackingSystemName"), "floorcop");
  EXPECT_EQ(sidecar.at("MotionChannelCount"), 4);
  EXPECT_EQ(sidecar.at("POSChannelCount"), 2);
  EXPECT_EQ(sidecar.at("MISCChannelCount"), 1);
  EXPECT_EQ(sidecar.at("LATENCYChannelCount"), 1);
  EXPECT_EQ(sidecar.at("TrackedPointsCount"), 1);
  EXPECT_NEAR(sidecar.at("RecordingDuration").get<double>(), 1.07, 1e-9);
  EXPECT_EQ(sidecar.at("DeviceSerialNumber"), "SIM0001");
  EXPECT_FALSE(sidecar.contains("DtsRecording")) << "BIDS validators refuse it";
  const auto facts = json("sourcedata/sub-P017/20261121T144525Z-floor-1_recording.json");
  EXPECT_EQ(facts.at("subject_fields").at("arm_length_cm"), "71");
  EXPECT_EQ(facts.at("damage"), "torn");
}

TEST_F(BidsExportTest, Events_HaveOnsetDurationAndType) {
  recording_.items.emplace_back(
      TimedEvent{.time_s = 8123.261,
                 .event = {.event = "trial", .scan = {1}, .values = {{"phase", std::string("go")}, {"condition", std::string("120\t%")}}}});
  ASSERT_TRUE(run().has_value());

  EXPECT_THAT(lines(kStem + "floorcop_events.tsv"), ElementsAre("onset\tduration\ttrial_type\tvalue\tcondition\tsegment\tscan\tdetails",
                                                                "0.000000\tn/a\tsegment\tn/a\tn/a\t0\t0\t{\"host_time_ns\":8123251000000}",
                                                                "0.020000\t0\tmarker\teyes \"closed\", now\tn/a\t0\t2\tn/a",
                                                                "1.050000\tn/a\tsegment\tunplugged\tn/a\t1\t0\t{\"missing_scans\":100}",
                                                                "0.010000\tn/a\ttrial\tgo\t120 %\t0\t1\t{\"condition\":\"120\\t%\"}"));
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

  const auto exported = run();

  ASSERT_FALSE(exported.has_value());
  EXPECT_EQ(exported.error().code, core::ErrorCode::WrongState);
  EXPECT_EQ(files(), before);
  EXPECT_EQ(lines("participants.tsv").size(), 2U);
}

TEST_F(BidsExportTest, PseudonymsThatBecomeOneLabel_AreToldNotMixed) {
  ASSERT_TRUE(run().has_value());
  recording_.facts->subject = "P017";
  recording_.facts->session_id = "another";

  const auto exported = run();

  ASSERT_FALSE(exported.has_value());
  EXPECT_EQ(exported.error().code, core::ErrorCode::WrongState);
  EXPECT_THAT(exported.error().what, HasSubstr("sub-P017"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sub-P017/ses-another"));
}

TEST_F(BidsExportTest, SubjectsThatDifferOnlyInCase_AreToldNotMixed) {
  recording_.facts->subject = "P1";
  ASSERT_TRUE(run().has_value());
  recording_.facts->subject = "p1";
  recording_.facts->session_id = "another";

  const auto exported = run();

  ASSERT_FALSE(exported.has_value());
  EXPECT_EQ(exported.error().code, core::ErrorCode::WrongState);
  EXPECT_THAT(exported.error().what, HasSubstr("upper from lower case"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sub-p1"));
}

TEST_F(BidsExportTest, FolderOfSomethingElse_IsLeftAlone) {
  write("holiday.txt", "mine");
  EXPECT_EQ(run().error().code, core::ErrorCode::WrongState);
  EXPECT_THAT(files(), ElementsAre("holiday.txt"));

  write("dataset_description.json", R"({"Name": "of somebody else", "BIDSVersion": "1.9.0"})");
  EXPECT_EQ(run().error().code, core::ErrorCode::WrongState);
  EXPECT_THAT(files(), ElementsAre("dataset_description.json", "holiday.txt"));
}

TEST_F(BidsExportTest, Stopped_LeavesNothing) {
  const auto exported = run([](std::uint64_t, std::uint64_t) { return false; });

  ASSERT_FALSE(exported.has_value());
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

  const auto exported = run();

  ASSERT_FALSE(exported.has_value());
  EXPECT_EQ(exported.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_FALSE(std::filesystem::exists(folder_));
}

}  // namespace
}  // namespace dts::record
