// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_table.h"
#include "posturography/measure.h"
#include "unit/lab/sway/sway_files.h"

namespace dts::lab::sway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class SwayTest : public RunTest {
 protected:
  [[nodiscard]] double value(const std::string& symbol) const { return json().at("measures").at(symbol).at("value").get<double>(); }
};

TEST_F(SwayTest, CircleAsIs_HasTheMeasuresOfACircle) {
  const std::string file = write("circle.csv", made::circle(2000));  // four turns of 500 rows

  ASSERT_EQ(run_with({"sway", file, "--profile", "asis", "--json"}), cli::kOk) << talk();

  const auto document = json();
  EXPECT_EQ(document.at("file"), file);
  EXPECT_EQ(document.at("profile"), "asis");
  EXPECT_EQ(document.at("fs_hz"), 100.0);
  EXPECT_EQ(document.at("n"), 2000);
  EXPECT_EQ(document.at("duration_s"), 20.0);
  EXPECT_EQ(document.at("valid"), true);
  EXPECT_EQ(document.at("estimator"), "MT8");
  EXPECT_THAT(document.at("flags"), ::testing::ElementsAre("short_for_diffusion"));
  const double path_mm = 1999 * 20.0 * std::sin(std::numbers::pi / 500.0);
  EXPECT_NEAR(value("RDIST"), 10.0, 1e-9);
  EXPECT_NEAR(value("MDIST"), 10.0, 1e-9);
  EXPECT_NEAR(value("RDIST_AP"), std::sqrt(50.0), 1e-9);
  EXPECT_NEAR(value("TOTEX"), path_mm, 1e-8);
  EXPECT_NEAR(value("MVELO"), path_mm / 20.0, 1e-9);
  EXPECT_NEAR(value("RANGE"), 20.0, 1e-9);
  EXPECT_NEAR(value("MAXDIST"), 10.0, 1e-9);
  EXPECT_NEAR(value("AREA_CE"), 300.0 * std::numbers::pi, 1e-7);
  EXPECT_EQ(document.at("measures").at("MVELO").at("unit"), "mm/s");
  EXPECT_EQ(document.at("measures").at("PEA95_F").at("unit"), "mm2");
  EXPECT_FALSE(document.at("measures").contains("SDA_DS_AP")) << "20 s are too short";
  EXPECT_FALSE(document.at("measures").contains("AP_USE"));
}

TEST_F(SwayTest, DefaultDefinition_IsTheLowPassAtTheFilesRate) {
  const std::string file = write("sway.csv", made::swaying(3100, 4.0, 0.3));

  ASSERT_EQ(run_with({"sway", file, "--json"}), cli::kOk) << talk();
  EXPECT_EQ(json().at("profile"), "lp10");
  EXPECT_EQ(json().at("fs_hz"), 100.0);
  EXPECT_EQ(json().at("settings").at("sample_entropy").at("rate_hz"), 20.0);
  EXPECT_EQ(json().at("settings").at("sample_entropy").at("n"), 620);
  EXPECT_TRUE(json().at("measures").contains("SAMPEN_AP_20HZ"));
  EXPECT_TRUE(json().at("measures").contains("SDA_DS_AP"));

  ASSERT_EQ(run_with({"sway", file, "--json", "--rate", "50", "--trim", "1", "--foot-length", "250"}), cli::kOk) << talk();
  EXPECT_EQ(json().at("fs_hz"), 50.0);
  EXPECT_EQ(json().at("n"), 1500);
  EXPECT_EQ(json().at("settings").at("trim_s"), 1.0);
  EXPECT_NEAR(value("AP_USE"), 100.0 * value("RANGE_AP") / 250.0, 1e-9);
}

TEST_F(SwayTest, OnATerminal_EveryMeasureStandsWithItsSentence) {
  ASSERT_EQ(run_with({"sway", write("sway.csv", made::swaying(1500, 4.0, 0.3))}), cli::kOk) << talk();

  EXPECT_THAT(out(), HasSubstr("profile lp10, 15 s, 1500 samples at 100 Hz"));
  EXPECT_THAT(out(), HasSubstr("Areas"));
  EXPECT_THAT(out(), HasSubstr("short_for_quantiles: Under 20 s"));
  EXPECT_THAT(out(), Not(HasSubstr("PF95")));
  for (const auto measure : {posturography::Measure::Mvelo, posturography::Measure::Pea95F, posturography::Measure::SampenAp}) {
    EXPECT_THAT(out(), HasSubstr(posturography::info(measure).sentence));
  }
}

TEST_F(SwayTest, MissingCells_AreCountedAndNeverSpread) {
  std::string text = made::swaying(2000, 4.0, 0.3);
  for (const char* time : {"\n5.00,", "\n5.01,", "\n9.00,"}) {
    const std::size_t at = text.find(time) + 6;
    text.replace(at, text.find('\n', at) - at, ",");
  }

  ASSERT_EQ(run_with({"sway", write("holes.csv", text), "--json"}), cli::kOk) << talk();

  EXPECT_EQ(json().at("n"), 2000);
  EXPECT_EQ(json().at("missing"), 3);
  EXPECT_EQ(json().at("interpolated"), 3);
  EXPECT_TRUE(json().at("measures").contains("MVELO"));
}

TEST_F(SwayTest, BadFiles_ExitWithTwoAndPlace) {
  const std::string head = "t_s,x_mm,y_mm\n";
  for (const auto& [text, says] : {std::pair(std::string(), ": is empty"),
                                   {"t,x_mm,y_mm\n0,1,2\n", ":1:1: column 't_s' is missing"},
                                   {head, ": has no rows"},
                                   {head + "0,1,2\n", ": a centre of pressure of 1 rows: at least two are needed"},
                                   {head + "0,1,2\n0.01,nan,2\n", ":3:6: x_mm: 'nan' is not a finite number"},
                                   {head + "0,1,2\n0.01,1,2\n0.01,1,2\n", ":4:1: t_s does not increase"},
                                   {head + "0,1,2\n0.01,1\n", ":3:1: 2 cells, the header has 3"}}) {
    const std::string file = write("bad.csv", text);
    EXPECT_EQ(refusal_of({"sway", file, "--json"}), "bad.csv" + std::string(says) + "\n");
    EXPECT_EQ(json(), (nlohmann::json{{"error", {{"code", "invalid_argument"}, {"message", file + says}}}}));
  }
  EXPECT_EQ(refusal_of({"sway", path("none.csv")}), "none.csv: no such file\n");
  EXPECT_EQ(run_with({"sway", write("bad.xdf", "this is no recording")}), cli::exit_status(core::ErrorCode::DataDamaged));
  EXPECT_EQ(talk(), "dtslab: " + path("bad.xdf") + " is not an XDF file\n  try: choose an XDF file: it starts with 'XDF:'\n");
}

TEST_F(SwayTest, OneBadFileOfMany_IsToldAndTheOthersGoOn) {
  const std::string good = write("good.csv", made::circle(1100));
  const std::string bad = write("bad.csv", "t_s,x_mm,y_mm\n0,1,2\n0.01,one,2\n");

  EXPECT_EQ(run_with({"sway", bad, good, good, "--json"}), cli::kUsage);

  EXPECT_EQ(json().at("trials").size(), 2U);
  EXPECT_EQ(json().at("problems").size(), 1U);
  EXPECT_THAT(talk(), HasSubstr("bad.csv:3:6"));
}

TEST_F(SwayTest, FolderIsWalkedThrough_WithoutTheTableItself) {
  std::filesystem::create_directories(directory_ / "all" / "deep");
  write("all/b.csv", made::circle(1100));
  write("all/deep/a.csv", made::circle(1200));
  write("all/notes.txt", "nothing");

  for (int again = 0; again < 2; ++again) {
    ASSERT_EQ(run_with({"sway", path("all"), "--label", "eyes=open", "--table", path("all/out.csv"), "--json"}), cli::kOk) << talk();
    ASSERT_EQ(json().at("trials").size(), 2U);
    EXPECT_EQ(json().at("trials").at(1).at("n"), 1200);
    EXPECT_EQ(json().at("trials").at(0).at("labels").at("eyes"), "open");
  }
  EXPECT_EQ(run_with({"sway", path("all/deep/nothing")}), cli::kUsage);
}

TEST_F(SwayTest, RepairedCopyInAFolder_StandsForTheRecordingThatACrashLeftOpen) {
  std::filesystem::create_directories(directory_ / "all");
  ASSERT_EQ(run_with({"simulate", "floor", "--duration", "16", "--rate", "200", "--out", path("all/s.recovered.xdf")}), cli::kOk) << talk();
  ASSERT_EQ(run_with({"sway", path("all"), "--json"}), cli::kOk) << talk();
  const std::size_t trials = json().at("trials").size();
  std::filesystem::copy_file(directory_ / "all/s.recovered.xdf", directory_ / "all/s.xdf.part");

  ASSERT_EQ(run_with({"sway", path("all"), "--json"}), cli::kOk) << talk();
  EXPECT_EQ(json().at("trials").size(), trials);
}

TEST_F(SwayTest, SimulatedRecording_IsMeasuredByTheReportsDefinition) {
  const std::string file = path("standing.xdf");
  ASSERT_EQ(run_with({"simulate", "floor", "--duration", "16", "--rate", "200", "--out", file}), cli::kOk) << talk();

  ASSERT_EQ(run_with({"sway", file, "--json"}), cli::kOk) << talk();

  ASSERT_GE(json().at("trials").size(), 1U);
  const auto trial = json().at("trials").at(0);
  EXPECT_EQ(trial.at("profile"), "lp10");
  EXPECT_NEAR(trial.at("fs_hz").get<double>(), 100.0, 1.0);
  EXPECT_TRUE(trial.contains("session"));
  EXPECT_TRUE(trial.at("measures").contains("MVELO"));
  EXPECT_EQ(json().at("recorded_results"), 0);
}

TEST_F(SwayTest, WrongUsage_SaysWhatIsMeant) {
  const std::string file = write("circle.csv", made::circle(1100));
  const std::string longest = "eyes=" + std::string(195, 'x');
  for (const auto& [words, says] :
       {std::pair(std::vector<std::string>{"--profile", "lp5"},
                  std::string("dtslab: sway: --profile: lp5 not in {asis,lp10}\n  try: dtslab sway --help\n")),
        {{"--label", "eyes"}, "dtslab: --label eyes: is not NAME=VALUE\n  try: --label eyes=open\n"},
        {{"--label", "=open"}, "dtslab: --label =open: is not NAME=VALUE\n  try: --label eyes=open\n"},
        {{"--label", "eyes="}, "dtslab: --label eyes=: is not NAME=VALUE\n  try: --label eyes=open\n"},
        {{"--label", longest + "x"}, "dtslab: --label " + longest + "x: is too long\n  try: at most 200 bytes\n"},
        {{"--label", "MVELO=3"}, "dtslab: --label MVELO=3: tables already have a column with this name\n  try: choose another name\n"},
        {{"--label", "eyes=o\x1fn"}, "dtslab: --label eyes=o n: has control characters\n  try: letters and digits\n"},
        {{"--label", "eyes=open,closed"},
         "dtslab: --label eyes=open,closed: 2 values for 1 files\n  try: give one value, or one value per file\n"},
        {{"--rate", "nan"}, "dtslab: sway: --rate: 'nan' is not a number of hertz from 10 to 100000\n  try: dtslab sway --help\n"},
        {{"--compare"},
         "dtslab: --compare needs exactly two measured trials, not 1\n  try: give two files, or select two trials of a recording: --trials "
         "1,2\n"},
        {{"--table", file}, "dtslab: circle.csv is the input file circle.csv\n  try: write to another file\n"}}) {
    std::vector<std::string> all{"sway", file};
    all.insert(all.end(), words.begin(), words.end());
    EXPECT_EQ(refusal_of(all), says);
  }
  EXPECT_EQ(content("circle.csv"), made::circle(1100));
  EXPECT_EQ(
      run_with({"sway", file, "--label", longest, "--label", "subject=A", "--label", "session=B", "--label", "condition=C", "--json"}),
      cli::kOk);
  EXPECT_EQ(json().at("subject"), "A");
  EXPECT_EQ(json().at("session"), "B");
  EXPECT_EQ(json().at("condition"), "C");
}

// Sheet section 10, d01: computed independently, and published by the dataset's authors.
TEST_F(SwayTest, RealRecording_HasThePublishedFigures) {
  RecordProperty("requirement", "SWAY-2");
  const std::string file = std::string(DTS_SOURCE_DIR) + "/../shared/data/cop/d01_bds00073_young_eo_firm.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recordings beside this checkout";

  ASSERT_EQ(run_with({"sway", file, "--profile", "asis", "--json"}), cli::kOk) << talk();

  EXPECT_NEAR(value("PEA95_F"), 304.5967518695401, 1e-9 * 304.6);
  EXPECT_NEAR(value("MVELO"), 8.187831842, 1e-9);
}

}  // namespace
}  // namespace dts::lab::sway
