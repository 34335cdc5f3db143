// SPDX-License-Identifier: Apache-2.0
#include "gateway/http/json_answer.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "dts/error.h"
#include "dts/v1/control.pb.h"

namespace dts::gateway {
namespace {

using client::ErrorCode;

TEST(JsonAnswer, ErrorSaysWhatAndWhatToTry) {
  const HttpResponse answer = error_answer(client::Error{ErrorCode::NotFound, "no session 'x'\n\xff", "list them"});

  EXPECT_EQ(answer.status, 404U);
  EXPECT_EQ(answer.content_type, "application/json");
  EXPECT_EQ(std::get<std::string>(answer.body), "{\"what\":\"no session 'x'\\n\xef\xbf\xbd\",\"hint\":\"list them\"}\n");
}

TEST(JsonAnswer, StatusFollowsFromTheCode) {
  const std::vector<std::pair<ErrorCode, unsigned>> expected{
      {ErrorCode::Failed, 500},     {ErrorCode::InvalidArgument, 400}, {ErrorCode::Unreachable, 503},   {ErrorCode::NotAllowed, 403},
      {ErrorCode::NotFound, 404},   {ErrorCode::WrongState, 409},      {ErrorCode::DataDamaged, 422},   {ErrorCode::Timeout, 504},
      {ErrorCode::DeviceGone, 503}, {ErrorCode::Unsupported, 501},     {ErrorCode::LimitExceeded, 429}, {ErrorCode::Internal, 500}};

  EXPECT_EQ(expected.size(), static_cast<std::size_t>(v1::ErrorCode_ARRAYSIZE) - 1) << "every code but UNSPECIFIED";
  for (const auto& [code, status] : expected) EXPECT_EQ(http_status(static_cast<int>(code)), status) << name(code);
  EXPECT_EQ(http_status(0), 500U);
  EXPECT_EQ(http_status(999), 500U);
}

}  // namespace
}  // namespace dts::gateway
