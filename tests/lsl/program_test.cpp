// SPDX-License-Identifier: Apache-2.0
// dts-lsl without what it needs: it says what is wrong and what to do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "lsl/lsl_system.h"
#include "support/temporary_folder.h"

namespace dts::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Finished run_with(const std::string& config) {
  const TemporaryFolder folder;
  const std::string file = folder.path() + "/lsl.toml";
  std::ofstream(file) << config;
  return run_lsl({"--config", file}, {"DTSD_RUNTIME_DIR=" + folder.path()});
}

TEST(LslProgram, WithoutLiblsl_SaysHowToGetIt) {
  const Finished missing = run_with("[lsl]\nlibrary = \"/nonexistent/liblsl.so\"\n");
  EXPECT_EQ(missing.status, 5);
  EXPECT_THAT(missing.err,
              AllOf(HasSubstr("liblsl cannot be loaded: /nonexistent/liblsl.so"), HasSubstr("github.com/sccn/liblsl/releases")));
  const Finished other = run_with("[lsl]\nlibrary = \"libm.so.6\"\n");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("libm.so.6 has no function lsl_library_version"));
}

TEST(LslProgram, DaemonOnAnotherMachine_IsRejected) {
  const Finished other = run_lsl({}, {"DTSD_CONTROL=tcp://192.168.1.2:5555", "DTSD_DATA=tcp://192.168.1.2:5556"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, AllOf(HasSubstr("DTSD_CONTROL"), HasSubstr("ipc://")));
}

TEST(LslProgram, WrongFile_IsNamedWithLineAndColumn) {
  const Finished wrong = run_with("[lsl]\nbuffer_s = 0\nmarker_from = \"name='x'\"\n[daemon]\ndata = \"tcp://192.168.1.2:5555\"\n");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, AllOf(HasSubstr("lsl.toml:2:"), HasSubstr("markers_from"), HasSubstr("must begin with ipc://")));
  EXPECT_EQ(run_lsl({"--nonsense"}).status, 2);
  EXPECT_EQ(run_lsl({"--version"}).status, 0);
}

}  // namespace
}  // namespace dts::test
