// SPDX-License-Identifier: Apache-2.0
#include "core/result.h"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <utility>

namespace dts::core {
namespace {

// The numbers travel on the wire and become exit codes, the words are in logs and JSON: they must never move.
TEST(ErrorCode, NumbersAndWords_AreStable) {
  using enum ErrorCode;
  constexpr std::array kCodes = {Failed,      InvalidArgument, Unreachable, NotAllowed,  NotFound,      WrongState,
                                 DataDamaged, Timeout,         DeviceGone,  Unsupported, LimitExceeded, Internal};
  constexpr std::array kWords = {"failed",       "invalid_argument", "unreachable", "not_allowed", "not_found",      "wrong_state",
                                 "data_damaged", "timeout",          "device_gone", "unsupported", "limit_exceeded", "internal"};
  for (std::size_t i = 0; i < kCodes.size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(kCodes.at(i)), i + 1);
    EXPECT_EQ(name(kCodes.at(i)), kWords.at(i));
  }
  for (const int none : {0, 13, 255}) EXPECT_EQ(name(static_cast<ErrorCode>(none)), "unknown");
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

TEST(Result, FailErrno_NamesTheSystemsReasonAndTellsRefusalAndAbsenceApart) {
  for (const auto& [number, error] : {std::pair{ENOSPC, Error{ErrorCode::Failed, "writing: No space left on device", "delete"}},
                                      {EIO, Error{ErrorCode::Failed, "writing: Input/output error", "delete"}},
                                      {EACCES, Error{ErrorCode::NotAllowed, "writing: Permission denied", "delete"}},
                                      {EPERM, Error{ErrorCode::NotAllowed, "writing: Operation not permitted", "delete"}},
                                      {ENOENT, Error{ErrorCode::NotFound, "writing: No such file or directory", "delete"}}}) {
    EXPECT_EQ(Status(fail_errno(number, "writing", "delete")).error(), error);
  }
}

}  // namespace
}  // namespace dts::core
