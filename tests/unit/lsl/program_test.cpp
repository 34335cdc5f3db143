// SPDX-License-Identifier: Apache-2.0
#include "lsl/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "lsl/liblsl.h"

namespace dts::lsl {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Ran {
  int status;
  std::string out;
  std::string talk;
};

Ran run_words(const std::vector<std::string>& words) {
  std::ostringstream out;
  std::ostringstream talk;
  cli::Console console{.out = out, .talk = talk, .program = "dts-lsl", .is_out_closed = [] { return false; }};
  const int status = run(words, console);
  return {status, out.str(), talk.str()};
}

TEST(LslCommandLine, Help_StartsWithExamplesAndNeedsNoCommand) {
  const Ran help = run_words({"--help"});
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("dts-lsl --config /etc/dtsd/lsl.toml"));
  EXPECT_THAT(help.out, HasSubstr("Usage: dts-lsl [OPTIONS]\n"));
  EXPECT_LT(help.out.find("Common tasks"), help.out.find("Usage"));
  EXPECT_THAT(run_words({"man"}).out, HasSubstr("[\\fICOMMAND\\fR [\\fIARGUMENTS\\fR]]"));
}

TEST(LslCommandLine, WrongWords_AreNamed) {
  const Ran wrong = run_words({"--confg", "x"});
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.talk, HasSubstr("unexpected option '--confg'"));
  const Ran incomplete = run_words({"--config"});
  EXPECT_EQ(incomplete.status, 2);
  EXPECT_THAT(incomplete.talk, Not(HasSubstr("a command is missing")));
}

TEST(LslCommandLine, AbsentFile_IsNamed) {
  const Ran absent = run_words({"--config", "/nonexistent/lsl.toml"});
  EXPECT_EQ(absent.status, 2);
  EXPECT_THAT(absent.talk, HasSubstr("/nonexistent/lsl.toml"));
}

TEST(LiblslLoad, AbsentOrOtherLibrary_IsRejectedWithAHint) {
  const auto absent = Liblsl::load("/nonexistent/liblsl.so");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().code, core::ErrorCode::NotFound);
  EXPECT_THAT(absent.error().hint, HasSubstr("install liblsl"));
  const auto other = Liblsl::load("libm.so.6");
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_THAT(other.error().what, HasSubstr("no function lsl_library_version"));
}

}  // namespace
}  // namespace dts::lsl
