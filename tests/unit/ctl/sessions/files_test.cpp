// SPDX-License-Identifier: Apache-2.0
// Commands about recordings that are given as files: no daemon is needed.
#include <csignal>
#include <filesystem>

#include "ctl/sessions/recorded_files.h"
#include "ctl/sessions/work_bar.h"
#include "unit/ctl/run_fixture.h"
#include "unit/ctl/sessions/made_recording.h"

namespace dts::ctl {
namespace {

TEST_F(RunTest, CtrlCDuringWork_StopsItAndIsForgottenAfterwards) {
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

TEST_F(RunTest, MeansFile_WhatExistsOrLooksLikeOne) {
  for (const std::string file : {"a.xdf", "a.xdf.part", "./a", "a/b", "/"}) EXPECT_TRUE(means_file(file)) << file;
  EXPECT_TRUE(means_file(directory_.path().string()));
  EXPECT_FALSE(means_file("20261121T144525Z-floor-1"));
}

TEST_F(RunTest, ExportAsFhir_IsOneBundleAndOverwritesNothing) {
  const std::string file = make_recording((directory_.path() / "a.xdf").string());
  const std::vector<std::string> command{"session", "export", file, "--format", "fhir", "--out", directory_.path().string(), "--json"};

  ASSERT_EQ(run_bare(command), cli::kOk) << talk();

  const std::string bundle = (directory_.path() / "20261121T144525Z-floor-1.fhir.json").string();
  EXPECT_EQ(json()["files"], nlohmann::json::array({bundle}));
  EXPECT_EQ(json()["bytes"], std::filesystem::file_size(bundle));
  EXPECT_EQ(json()["resources"], 4) << "patient, device, report and a trial";
  EXPECT_EQ(json()["has_pdf"], false) << "no page for this recording";
  EXPECT_THAT(talk(), ::testing::HasSubstr("the bundle has no PDF: "));
  EXPECT_NE(run_bare(command), cli::kOk);
  EXPECT_THAT(talk(), ::testing::HasSubstr("exists already"));
}

TEST_F(RunTest, ExportAsFhirOfATornFile_SaysSo) {
  const std::string file = make_recording((directory_.path() / "a.xdf").string(), Ending::Killed);

  ASSERT_EQ(run_bare({"session", "export", file, "--format", "fhir", "--out", directory_.path().string(), "--json"}), cli::kOk) << talk();

  ASSERT_EQ(json()["damaged"].size(), 1U);
  EXPECT_THAT(talk(), ::testing::HasSubstr("only the undamaged part is exported"));
}

}  // namespace
}  // namespace dts::ctl
