// SPDX-License-Identifier: Apache-2.0
#include "core/result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <set>
#include <string>

namespace dts::core {
namespace {

constexpr int kLastCode = static_cast<int>(ErrorCode::Internal);

TEST(ErrorCode, EveryCode_HasItsOwnWord) {
  std::set<std::string_view> words;
  for (int code = 1; code <= kLastCode; ++code) words.insert(name(static_cast<ErrorCode>(code)));

  EXPECT_EQ(words.size(), static_cast<std::size_t>(kLastCode));
  EXPECT_FALSE(words.contains("unknown"));
}

TEST(ErrorCode, ValueFromOutsideTheEnum_IsUnknown) {
  EXPECT_EQ(name(static_cast<ErrorCode>(0)), "unknown");
  EXPECT_EQ(name(static_cast<ErrorCode>(kLastCode + 1)), "unknown");
  EXPECT_EQ(name(static_cast<ErrorCode>(255)), "unknown");
}

// The numbers travel on the wire and become exit codes: they must never move.
TEST(ErrorCode, Numbers_AreStable) {
  EXPECT_EQ(static_cast<int>(ErrorCode::Failed), 1);
  EXPECT_EQ(static_cast<int>(ErrorCode::Unreachable), 3);
  EXPECT_EQ(static_cast<int>(ErrorCode::Timeout), 8);
  EXPECT_EQ(static_cast<int>(ErrorCode::Internal), 12);
}

TEST(Error, ToString_PutsTheHintInBrackets) {
  EXPECT_EQ(to_string(Error{ErrorCode::Failed, "disk full", ""}), "disk full");
  EXPECT_EQ(to_string(Error{ErrorCode::Failed, "disk full", "delete old sessions"}), "disk full (delete old sessions)");
}

TEST(Result, Fail_CarriesCodeWhatAndHint) {
  const Result<int> result = fail(ErrorCode::NotFound, "no rig \"chair\"", "see: dtsctl rig list");

  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error(), (Error{ErrorCode::NotFound, "no rig \"chair\"", "see: dtsctl rig list"}));
}

TEST(Result, FailErrno_NamesTheSystemsReason) {
  const Status status = fail_errno(ENOSPC, "cannot write \"a.xdf\"");

  EXPECT_EQ(status.error().code, ErrorCode::Failed);
  EXPECT_EQ(status.error().what, "cannot write \"a.xdf\": No space left on device");
}

TEST(Result, FailErrno_DistinguishesRefusalAndAbsence) {
  const auto code_of = [](int system_errno) { return Status(fail_errno(system_errno, "x")).error().code; };

  EXPECT_EQ(code_of(EACCES), ErrorCode::NotAllowed);
  EXPECT_EQ(code_of(EPERM), ErrorCode::NotAllowed);
  EXPECT_EQ(code_of(ENOENT), ErrorCode::NotFound);
  EXPECT_EQ(code_of(EIO), ErrorCode::Failed);
}

}  // namespace
}  // namespace dts::core
