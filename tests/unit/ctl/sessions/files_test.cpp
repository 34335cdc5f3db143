// SPDX-License-Identifier: Apache-2.0
// Commands about recordings that are given as files: no daemon is needed.
#include <csignal>

#include "ctl/sessions/recorded_files.h"
#include "ctl/sessions/work_bar.h"
#include "unit/ctl/run_fixture.h"

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

}  // namespace
}  // namespace dts::ctl
