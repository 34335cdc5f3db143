// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/progress_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

namespace dts::ctl {
namespace {

using client::Error;
using client::ErrorCode;

class ProgressFiles : public ::testing::Test {
 protected:
  ProgressFiles() {
    std::string pattern = ::testing::TempDir() + "dts-progress-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
  }
  ~ProgressFiles() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path path() const { return folder_ / "state" / "dts" / "floor.jsonl"; }
  [[nodiscard]] static cli::Json calibration(const std::string& rig = "floor") {
    return {{"format", 1}, {"rig", rig}, {"points", {{86.0, 215.0, 490.0}, {150.5, 215.0, 490.0}, {215.0, 215.0, 490.0}}}};
  }
  [[nodiscard]] client::Result<ProgressFile> resume(const std::string& rig = "floor") const {
    return ProgressFile::resume(path(), calibration(rig), 3, 2);
  }
  /// A file with the first `count` points.
  void measure(std::size_t count) const {
    auto progress = ProgressFile::create(path(), calibration());
    ASSERT_TRUE(progress) << progress.error().what;
    for (std::size_t k = 0; k < count; ++k) ASSERT_TRUE(progress->record(k, reading(k)));
  }
  [[nodiscard]] static SteadyReading reading(std::size_t index) {
    return {.mean = {1.0 / 3.0 + static_cast<double>(index), 2.0}, .noise = {0.003, 0.004}, .scans = 300};
  }
  void append(const std::string& text) const { std::ofstream(path(), std::ios::app) << text; }
  [[nodiscard]] std::string content() const {
    std::ifstream file(path());
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }

  std::filesystem::path folder_;
};

TEST_F(ProgressFiles, Resumed_HasExactlyWhatWasRecorded) {
  measure(2);

  const auto progress = resume();

  ASSERT_TRUE(progress) << progress.error().what;
  EXPECT_EQ(progress->next(), 2U);
  ASSERT_TRUE(progress->points()[1]);
  EXPECT_EQ(progress->points()[1]->mean, reading(1).mean);
  EXPECT_EQ(progress->points()[1]->noise, reading(1).noise);
  EXPECT_EQ(progress->points()[1]->scans, 300U);
  EXPECT_FALSE(progress->points()[2]);
}

TEST_F(ProgressFiles, LineCutOffByACrash_IsRemovedAndTheNextOneWhole) {
  measure(1);
  append("{\"index\": 1, \"mean\": [1.0,");
  {
    auto progress = resume();
    ASSERT_TRUE(progress) << progress.error().what;
    EXPECT_EQ(progress->next(), 1U);
    ASSERT_TRUE(progress->record(1, reading(1)));
  }

  const auto again = resume();

  ASSERT_TRUE(again) << again.error().what << "\n" << content();
  EXPECT_EQ(again->next(), 2U);
}

TEST_F(ProgressFiles, MeasuredAgain_TheLaterCounts) {
  {
    auto progress = ProgressFile::create(path(), calibration());
    ASSERT_TRUE(progress);
    ASSERT_TRUE(progress->record(0, reading(0)));
    ASSERT_TRUE(progress->forget(0));
    EXPECT_EQ(progress->next(), 0U);
    ASSERT_TRUE(progress->record(0, reading(5)));
  }

  EXPECT_EQ(resume()->points()[0]->mean, reading(5).mean);
}

TEST_F(ProgressFiles, ToBeMeasuredAgain_IsMissingAfterACrash) {
  measure(2);
  ASSERT_TRUE(resume()->forget(0));

  const auto progress = resume();

  ASSERT_TRUE(progress) << progress.error().what;
  EXPECT_EQ(progress->next(), 0U);
  EXPECT_TRUE(progress->points()[1]);
}

TEST_F(ProgressFiles, OtherRig_RefusedSayingWhatDiffers) {
  measure(1);

  const auto progress = resume("other");

  EXPECT_EQ(progress.error(),
            (Error{ErrorCode::WrongState, path().string() + " belongs to another calibration: rig was \"floor\", now it is \"other\"",
                   "use --resume without other options: it uses those of the file; or start again with --fresh"}));
}

TEST_F(ProgressFiles, NothingThere_WrongState) {
  const Error nothing{ErrorCode::WrongState, "there is nothing to resume: " + path().string() + " does not exist", "leave out --resume"};
  EXPECT_EQ(resume().error(), nothing);
  EXPECT_EQ(ProgressFile::calibration_in(path()).error(), nothing);
}

TEST_F(ProgressFiles, DamagedHead_IsCalledDamaged) {
  std::filesystem::create_directories(path().parent_path());
  append("{\"calib\n");

  const Error damaged{ErrorCode::DataDamaged, path().string() + ":1: damaged: the line with the properties of the calibration is missing",
                      "start again with --fresh"};
  EXPECT_EQ(resume().error(), damaged);
  EXPECT_EQ(ProgressFile::calibration_in(path()).error(), damaged);
}

TEST_F(ProgressFiles, Head_IsWhatWasGiven) {
  measure(1);

  EXPECT_EQ(ProgressFile::calibration_in(path()).value(), calibration());
}

TEST_F(ProgressFiles, DamagedInTheMiddle_RefusedWithItsLine) {
  for (const char* line :
       {"nonsense", "[]", "{}", R"({"index": 3, "mean": [1, 2], "noise": [1, 2], "scans": 9})",
        R"({"index": -1, "mean": [1, 2], "noise": [1, 2], "scans": 9})", R"({"index": 0, "mean": [1], "noise": [1, 2], "scans": 9})",
        R"({"index": 0, "mean": [1, null], "noise": [1, 2], "scans": 9})", R"({"index": 0, "mean": [1, 2], "scans": 9})",
        R"({"index": 3, "redo": true})", R"({"index": 0, "redo": "yes"})"}) {
    measure(1);
    append(std::string(line) + "\n");

    const auto progress = resume();

    ASSERT_FALSE(progress) << line;
    EXPECT_EQ(progress.error(), (Error{ErrorCode::DataDamaged, path().string() + ":3: not a point", "start again with --fresh"})) << line;
  }
}

TEST_F(ProgressFiles, EmptyFile_IsNoProgress) {
  std::filesystem::create_directories(path().parent_path());
  append("");

  EXPECT_EQ(resume().error().code, ErrorCode::DataDamaged);
}

TEST_F(ProgressFiles, InUse_TheSecondIsRefused) {
  const auto first = ProgressFile::create(path(), calibration());
  ASSERT_TRUE(first);

  const Error in_use{ErrorCode::WrongState, path().string() + " is in use: another calibration of this rig is running",
                     "end the other calibration first"};
  EXPECT_EQ(resume().error(), in_use);
  EXPECT_EQ(ProgressFile::create(path(), calibration()).error(), in_use);
}

TEST_F(ProgressFiles, Finished_IsGone) {
  measure(1);

  resume()->finish();

  EXPECT_FALSE(std::filesystem::exists(path()));
}

TEST(StateFolder, XdgThenHome) {
  const auto with = [](const char* state, const char* home) {
    return state_folder([=](const char* name) { return std::string_view(name) == "HOME" ? home : state; });
  };

  EXPECT_EQ(with("/x", "/home/a")->string(), "/x/dts");
  EXPECT_EQ(with(nullptr, "/home/a")->string(), "/home/a/.local/state/dts");
  EXPECT_EQ(with("relative", "/home/a")->string(), "/home/a/.local/state/dts");  // the XDG specification: ignore relative paths
  EXPECT_EQ(with(nullptr, nullptr).error().code, ErrorCode::Failed);
}

}  // namespace
}  // namespace dts::ctl
