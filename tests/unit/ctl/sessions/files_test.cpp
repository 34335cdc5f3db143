// SPDX-License-Identifier: Apache-2.0
// Commands about recordings that are given as files: no daemon is needed.
#include <csignal>
#include <filesystem>
#include <fstream>

#include "ctl/sessions/recorded_files.h"
#include "ctl/sessions/work_bar.h"
#include "made_recording.h"
#include "unit/ctl/run_fixture.h"

namespace dts::ctl {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class FilesTest : public RunTest {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (directory_.path() / name).string(); }
  /// Overwrites a byte in the middle, as a bad disk does.
  static void damage(const std::string& file) {
    fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
    std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(static_cast<std::streamoff>(fs::file_size(file) / 2));
    stream.put('\x55');
  }
};

TEST_F(FilesTest, Verify_WholeRecordingIsSound) {
  const std::string file = make_recording(path("a.xdf"));

  EXPECT_EQ(run_bare({"session", "verify", file}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("sound  " + file + ": complete, 2.5 s, 250 scans"));
  EXPECT_EQ(talk(), "");
}

TEST_F(FilesTest, VerifyWithoutIndex_DoesNotCallTheValuesSound) {
  const std::string file = make_recording(path("a.xdf"));
  fs::remove(file + ".idx");

  EXPECT_EQ(run_bare({"session", "verify", file}), cli::kOk);

  EXPECT_THAT(out(), AllOf(HasSubstr("readable  " + file), HasSubstr("the values were not checked"), Not(HasSubstr("sound"))));
}

TEST_F(FilesTest, ExportOfDamagedValues_IsRefused) {
  const std::string file = make_recording(path("a.xdf"));
  damage(file);

  EXPECT_EQ(run_bare({"session", "export", file, "--format", "csv", "--out", path("csv")}), 7);

  EXPECT_THAT(talk(), HasSubstr("dtsctl session recover"));
  EXPECT_FALSE(fs::exists(path("csv")));
}

TEST_F(FilesTest, VerifyJson_SaysEverything) {
  const std::string file = make_recording(path("a.xdf"));

  EXPECT_EQ(run_bare({"session", "verify", file, "--json"}), cli::kOk);

  EXPECT_EQ(json().at("ok"), true);
  const auto found = json().at("files").at(0);
  EXPECT_EQ(found.at("state"), "complete");
  EXPECT_EQ(found.at("scans"), 250);
  EXPECT_EQ(found.at("has_index"), true);
  EXPECT_EQ(found.at("sha256").get<std::string>().size(), 64U);
  EXPECT_FALSE(found.contains("problem"));
  EXPECT_FALSE(found.contains("part"));
}

TEST_F(FilesTest, VerifyOfIncompleteRecording_ExitsWithZeroAndSaysSoLoudly) {
  const std::string file = make_recording(path("a.xdf"), Ending::Incomplete);

  EXPECT_EQ(run_bare({"session", "verify", file}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("INCOMPLETE  " + file));
  EXPECT_THAT(out(), HasSubstr("disk full"));
}

TEST_F(FilesTest, VerifyOfKilledRecording_IsInterruptedAndRecoverIsOffered) {
  const std::string file = make_recording(path("a.xdf"), Ending::Killed);
  console_.is_talk_terminal = true;

  EXPECT_EQ(run_bare({"session", "verify", file}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr("INTERRUPTED  " + file));
  EXPECT_THAT(talk(), HasSubstr("dtsctl session recover " + file));
}

TEST_F(FilesTest, VerifyOfDamagedRecording_ExitsWithSeven) {
  const std::string file = make_recording(path("a.xdf"));
  damage(file);

  EXPECT_EQ(run_bare({"session", "verify", file}), 7);
  EXPECT_THAT(out(), HasSubstr("DAMAGED  " + file));
  EXPECT_EQ(out().find(file), out().rfind(file)) << "named once: " << out();
  EXPECT_THAT(talk(), ::testing::StartsWith("dtsctl: " + file + ": "));
  EXPECT_EQ(talk().find(file), talk().rfind(file)) << talk();

  EXPECT_EQ(run_bare({"session", "verify", file, "--json"}), 7);
  EXPECT_EQ(json().at("ok"), false);
  EXPECT_TRUE(json().at("files").at(0).contains("problem"));
}

TEST_F(FilesTest, ExportIntoAFolderThatCannotBeMade_SaysWhatToDo) {
  const std::string file = make_recording(path("a.xdf"));

  EXPECT_NE(run_bare({"session", "export", file, "--format", "csv", "--out", "/proc/dts"}), cli::kOk);

  EXPECT_THAT(talk(), HasSubstr("choose a folder that you may write into"));
}

TEST_F(FilesTest, FileThatIsNoRecording_ExitsWithTwo) {
  std::ofstream(path("b.xdf")) << "PK";
  fs::create_directory(path("folder"));
  for (const char* command : {"verify", "recover"}) {
    for (const char* name : {"missing.xdf", "b.xdf", "folder"}) {
      EXPECT_EQ(run_bare({"session", command, path(name)}), 2) << command << " " << name;
      EXPECT_THAT(talk(), HasSubstr(path(name)));
      EXPECT_EQ(out(), "");
    }
  }
  EXPECT_EQ(run_bare({"session", "export", path("missing.xdf"), "--format", "csv"}), 2);
}

TEST_F(FilesTest, Recover_MakesACopyThatVerifies) {
  const std::string file = make_recording(path("a.xdf"), Ending::Killed);
  const auto size = fs::file_size(file);
  console_.is_talk_terminal = true;

  EXPECT_EQ(run_bare({"session", "recover", file}), cli::kOk);

  EXPECT_THAT(out(), HasSubstr(path("a.recovered.xdf")));
  EXPECT_THAT(out(), HasSubstr("at most"));
  EXPECT_THAT(talk(), HasSubstr("dtsctl session verify"));
  EXPECT_EQ(fs::file_size(file), size);
  EXPECT_EQ(run_bare({"session", "verify", path("a.recovered.xdf"), "--json"}), cli::kOk);
  EXPECT_EQ(json().at("files").at(0).at("state"), "recovered");
}

TEST_F(FilesTest, RecoverInto_NamedCopyAndNeverOverAnother) {
  const std::string file = make_recording(path("a.xdf"), Ending::Killed);
  EXPECT_EQ(run_bare({"session", "recover", file, "--out", path("b.xdf"), "--json"}), cli::kOk);
  EXPECT_EQ(json().at("file"), path("b.xdf"));
  EXPECT_GT(json().at("lost_s_at_most").get<double>(), 0.0);

  EXPECT_NE(run_bare({"session", "recover", file, "--out", path("b.xdf")}), cli::kOk);
  EXPECT_THAT(talk(), HasSubstr("b.xdf"));
}

TEST_F(FilesTest, RecoverOfWholeRecording_WrongState) {
  const std::string file = make_recording(path("a.xdf"));

  EXPECT_EQ(run_bare({"session", "recover", file}), 6);
}

TEST_F(FilesTest, ExportCsv_PrintsTheFilesItWrote) {
  const std::string file = make_recording(path("a.xdf"));

  EXPECT_EQ(run_bare({"session", "export", file, "--format", "csv", "--out", path("tables")}), cli::kOk);

  const std::string raw = path("tables/20261121T144525Z-floor-1_raw.csv");
  EXPECT_THAT(out(), HasSubstr(raw + "\n"));
  std::ifstream table(raw);
  std::string header;
  std::string first;
  std::getline(table, header);
  std::getline(table, first);
  EXPECT_EQ(header, "t_s,segment,scan,w1_v,w2_v");
  EXPECT_EQ(first, "0,0,0,0.5,0.5");

  EXPECT_EQ(run_bare({"session", "export", file, "--format", "csv", "--out", path("tables")}), 6) << "nothing is overwritten";
}

TEST_F(FilesTest, ExportBidsJson_CountsRowsAndBytes) {
  const std::string file = make_recording(path("a.xdf"));

  EXPECT_EQ(run_bare({"session", "export", file, "--format", "bids", "--out", path("study"), "--json"}), cli::kOk);

  EXPECT_EQ(json().at("rows"), 254);
  EXPECT_GT(json().at("bytes").get<int>(), 250);
  EXPECT_TRUE(fs::exists(path("study/dataset_description.json")));
  EXPECT_TRUE(fs::exists(path("study/sub-P017")));
}

TEST_F(FilesTest, ExportOfKilledRecording_ExportsWhatIsWholeAndSaysSo) {
  const std::string file = make_recording(path("a.xdf"), Ending::Killed);

  EXPECT_EQ(run_bare({"session", "export", file, "--format", "csv", "--out", path("tables")}), cli::kOk);

  EXPECT_THAT(talk(), HasSubstr(file));
  EXPECT_TRUE(fs::exists(path("tables/20261121T144525Z-floor-1_raw.csv")));
}

TEST_F(FilesTest, ExportJson_NamesWhatIsNotWhole) {
  const std::string incomplete = make_recording(path("a.xdf"), Ending::Incomplete);
  EXPECT_EQ(run_bare({"session", "export", incomplete, "--format", "csv", "--out", path("tables"), "--json"}), cli::kOk);
  EXPECT_EQ(json().at("damaged").at(0).at("file"), incomplete);
  EXPECT_THAT(json().at("damaged").at(0).at("damage").get<std::string>(), HasSubstr("disk full"));

  EXPECT_EQ(run_bare({"session", "export", make_recording(path("b.xdf")), "--format", "csv", "--out", path("b"), "--json"}), cli::kOk);
  EXPECT_FALSE(json().contains("damaged"));
}

TEST_F(FilesTest, ExportInAnUnknownFormat_UsageError) {
  EXPECT_EQ(run_bare({"session", "export", "a.xdf", "--format", "xls"}), cli::kUsage);
  EXPECT_THAT(talk(), HasSubstr("csv"));
}

TEST_F(FilesTest, CtrlCDuringWork_StopsItAndIsForgottenAfterwards) {
  {
    WorkBar work(console_, "exporting");
    const record::Progress progress = work.progress();
    EXPECT_TRUE(progress(1, 2));
    std::raise(SIGINT);
    EXPECT_FALSE(progress(2, 2));
    EXPECT_TRUE(work.is_interrupted());
  }
  const WorkBar next(console_, "exporting");
  EXPECT_FALSE(next.is_interrupted());
}

TEST_F(FilesTest, MeansFile_WhatExistsOrLooksLikeOne) {
  for (const std::string file : {"a.xdf", "a.xdf.part", "./a", "a/b", "/"}) EXPECT_TRUE(means_file(file)) << file;
  EXPECT_TRUE(means_file(directory_.path().string()));
  EXPECT_FALSE(means_file("20261121T144525Z-floor-1"));
}

}  // namespace
}  // namespace dts::ctl
