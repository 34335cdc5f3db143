// SPDX-License-Identifier: Apache-2.0
#include "core/result.h"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <memory>
#include <string>
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

// DTS_TRY and DTS_TRY_ASSIGN.

Error lost() { return {ErrorCode::DeviceGone, "chair: unplugged", "plug it in"}; }

/// Counts its calls; the one with number `failing` fails.
struct Calls {
  int failing = 0;
  int count = 0;

  Status check() {
    return number().map([](int) {});
  }

  Result<int> number() {
    if (++count == failing) return tl::make_unexpected(lost());
    return count;
  }

  Result<std::unique_ptr<int>> owned() {
    return number().map([](int value) { return std::make_unique<int>(value); });
  }
};

Status check_twice(Calls& calls) {
  DTS_TRY(calls.check());
  DTS_TRY(calls.number());  // its value is not needed
  return {};
}

TEST(Try, EachCallFails_ReturnsItsErrorAndDoesNotGoOn) {
  for (const int failing : {1, 2}) {
    Calls calls{.failing = failing};

    const Status status = check_twice(calls);

    ASSERT_FALSE(status);
    EXPECT_EQ(status.error(), lost());
    EXPECT_EQ(calls.count, failing);
  }
}

TEST(Try, NoCallFails_EvaluatesEachOnce) {
  Calls calls;

  EXPECT_TRUE(check_twice(calls));
  EXPECT_EQ(calls.count, 2);
}

TEST(Try, NamedResult_KeepsItsError) {
  const Status known = tl::make_unexpected(lost());
  const auto pass_on = [&]() -> Result<int> {
    DTS_TRY(known);
    return 1;
  };

  EXPECT_EQ(pass_on().error(), lost());
  EXPECT_EQ(known.error(), lost());
}

Status check_one(bool is_first, Calls& first, Calls& second) {
  if (is_first)
    DTS_TRY(first.check());
  else
    DTS_TRY(second.check());
  return {};
}

TEST(Try, BranchWithoutBraces_KeepsItsElse) {
  for (const bool is_first : {true, false}) {
    Calls first;
    Calls second;

    EXPECT_TRUE(check_one(is_first, first, second));
    EXPECT_EQ(first.count, is_first ? 1 : 0);
    EXPECT_EQ(second.count, is_first ? 0 : 1);
  }
}

Result<std::string> join_three(Calls& calls) {
  DTS_TRY_ASSIGN(const auto first, calls.number());
  DTS_TRY_ASSIGN(auto second, calls.owned());
  *second *= 10;
  int third = 0;
  DTS_TRY_ASSIGN(third, calls.number());
  return std::to_string(first) + " " + std::to_string(*second) + " " + std::to_string(third);
}

TEST(TryAssign, EachCallFails_ReturnsItsErrorAndDoesNotGoOn) {
  for (const int failing : {1, 2, 3}) {
    Calls calls{.failing = failing};

    const auto text = join_three(calls);

    ASSERT_FALSE(text);
    EXPECT_EQ(text.error(), lost());
    EXPECT_EQ(calls.count, failing);
  }
}

TEST(TryAssign, NoCallFails_GivesTheValues) {
  Calls calls;

  EXPECT_EQ(join_three(calls), "1 20 3");
  EXPECT_EQ(calls.count, 3);
}

// A loop, a block in it, and an expression with a comma outside of parentheses; -Wshadow watches the hidden names.
TEST(TryAssign, NestedBlocks_UseTheirOwnValues) {
  Calls calls;
  const auto add = [&]() -> tl::expected<int, Error> {
    int sum = 0;
    for (int i = 0; i < 3; ++i) {
      DTS_TRY_ASSIGN(const auto outer, calls.number());
      const auto inner_sum = [&]() -> Result<int> {
        DTS_TRY_ASSIGN(const auto inner, std::pair<int, Result<int>>{0, calls.number()}.second);
        return outer * inner;
      };
      DTS_TRY_ASSIGN(const auto product, inner_sum());
      sum += product;
    }
    return sum;
  };

  EXPECT_EQ(add(), 1 * 2 + 3 * 4 + 5 * 6);
}

}  // namespace
}  // namespace dts::core
