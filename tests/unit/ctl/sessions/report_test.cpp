// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <fstream>
#include <sstream>

#include "made_recording.h"
#include "unit/ctl/run_fixture.h"
#include "unit/report/made_standing.h"

namespace dts::ctl {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ReportCommandTest : public RunTest {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const { return (directory_.path() / name).string(); }
  [[nodiscard]] std::string standing() const {
    report::MadeStanding made{.length_s = 25.0};
    report::add_trial(made, 1, 2.0, 20.0, "eyes-open", {{"eyes", "open"}});
    return report::write_standing(path("a.xdf"), made);
  }
  static std::string content(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
};

TEST_F(ReportCommandTest, OfAFile_WritesPagesAndPrintsThem) {
  EXPECT_EQ(run_bare({"report", standing(), "--out", path("pages")}), cli::kOk);

  for (const char* name : {"session.html", "session.svg", "trial-01.html", "trial-01.svg"}) {
    EXPECT_THAT(out(), HasSubstr(path("pages") + "/" + name + "\n"));
    EXPECT_TRUE(fs::exists(path("pages") + "/" + name)) << name;
  }
  EXPECT_EQ(talk(), "");
}

TEST_F(ReportCommandTest, Format_Chooses) {
  EXPECT_EQ(run_bare({"--json", "report", standing(), "--format", "svg", "--out", path("pages")}), cli::kOk);

  EXPECT_EQ(json()["session_id"], "20261121T144525Z-floor-1");
  EXPECT_EQ(json()["pages"].size(), 2U);
  EXPECT_FALSE(fs::exists(path("pages/session.html")));
}

TEST_F(ReportCommandTest, Again_ReplacesPagesOfOurs) {
  const std::string file = standing();
  EXPECT_EQ(run_bare({"report", file, "--out", path("pages")}), cli::kOk);
  const std::string before = content(path("pages/session.html"));
  std::ofstream(path("pages/session.html"), std::ios::app) << "torn";

  EXPECT_EQ(run_bare({"report", file, "--out", path("pages")}), cli::kOk);

  EXPECT_EQ(content(path("pages/session.html")), before);
}

TEST_F(ReportCommandTest, FileOfSomebodyElse_IsNeverReplaced) {
  fs::create_directory(path("pages"));
  std::ofstream(path("pages/trial-01.svg")) << "my drawing";

  EXPECT_EQ(run_bare({"report", standing(), "--out", path("pages")}), 6);

  EXPECT_THAT(talk(), HasSubstr("is no page of a report"));
  EXPECT_EQ(content(path("pages/trial-01.svg")), "my drawing");
  EXPECT_FALSE(fs::exists(path("pages/session.html"))) << "all of them or none";
}

TEST_F(ReportCommandTest, RecordingWithoutCop_HasNone) {
  EXPECT_EQ(run_bare({"report", make_recording(path("b.xdf")), "--out", path("pages")}), 5);

  EXPECT_THAT(talk(), HasSubstr("floor platform"));
  EXPECT_FALSE(fs::exists(path("pages")));
}

TEST_F(ReportCommandTest, WhatIsNoRecording_IsBadInput) {
  std::ofstream(path("c.xdf")) << "no";
  EXPECT_EQ(run_bare({"report", path("c.xdf")}), cli::kUsage);
  EXPECT_EQ(run_bare({"report", path("none.xdf")}), cli::kUsage);
}

TEST_F(ReportCommandTest, DamagedValues_AreRefused) {
  const std::string file = standing();
  fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
  {
    std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(static_cast<std::streamoff>(fs::file_size(file) / 2));
    stream.put('\x55');
  }

  EXPECT_EQ(run_bare({"report", file, "--out", path("pages")}), 7);

  EXPECT_FALSE(fs::exists(path("pages")));
}

}  // namespace
}  // namespace dts::ctl
