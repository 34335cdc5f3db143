// SPDX-License-Identifier: Apache-2.0
#include "gateway/bus/command_pool.h"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "unit/gateway/answered_test.h"

namespace dts::gateway {
namespace {

using Answers = std::vector<std::string>;
using Clock = std::chrono::steady_clock;

v1::Request look() {
  v1::Request request;
  request.mutable_show_session()->set_session_id("s1");
  return request;
}

v1::Request stop() {
  v1::Request request;
  request.mutable_stop_session()->set_rig("floor");
  return request;
}

/// Never answers a look, every stop at once.
Answers stops_only(const v1::Request& request, int) {
  if (!request.has_stop_session()) return {};
  return {testing::reply(request, [](v1::Response& response) { response.mutable_session()->set_session_id("s1"); })};
}

class CommandPoolTest : public IoTest {
 protected:
  testing::TemporaryDirectory directory_;
  std::string endpoint_ = directory_.endpoint("control.sock");
};

TEST_F(CommandPoolTest, AFloodOfLooks_DoesNotKeepAStopFromTheDaemon) {
  const testing::FakeController daemon(endpoint_, stops_only);
  CommandPool pool(io_, endpoint_);
  std::size_t refused = 0;
  std::size_t looks_answered = 0;
  for (std::size_t times = 0; times < 3 * CommandPool::kMostWaiting; ++times) {
    pool.submit(look(), [&](const client::Result<v1::Response>& answer) {
      ++looks_answered;
      if (!answer && answer.error().code == client::ErrorCode::LimitExceeded) ++refused;
    });
  }

  std::optional<client::Result<v1::Response>> stopped;
  pool.submit(stop(), [&](client::Result<v1::Response> answer) { stopped = std::move(answer); });

  ASSERT_TRUE(runs_until([&] { return stopped.has_value(); }));
  EXPECT_TRUE(stopped->has_value()) << stopped->error().what;
  EXPECT_EQ(refused, 2 * CommandPool::kMostWaiting);
  EXPECT_LT(looks_answered, 3 * CommandPool::kMostWaiting) << "the stop waited for the looks";
}

TEST_F(CommandPoolTest, PlacesAreGivenBack) {
  const testing::FakeController daemon(endpoint_, stops_only);
  CommandPool pool(io_, endpoint_);
  std::size_t done = 0;

  for (std::size_t times = 0; times < CommandPool::kMostWaiting + 5; ++times) {
    pool.submit(stop(), [&](const client::Result<v1::Response>& answer) { done += answer ? 1U : 0U; });
    ASSERT_TRUE(runs_until([&] { return done == times + 1; }));
  }
}

TEST_F(CommandPoolTest, WithoutAnAddress_TheAnswerSaysSo) {
  CommandPool pool(io_, "");
  std::optional<client::ErrorCode> why;

  pool.submit(look(), [&](const client::Result<v1::Response>& answer) { why = answer.error().code; });

  ASSERT_TRUE(runs_until([&] { return why.has_value(); }));
  EXPECT_EQ(why, client::ErrorCode::InvalidArgument);
}

TEST_F(CommandPoolTest, Ends_WithoutWaitingForTheDaemon) {
  const testing::FakeController daemon(endpoint_, [](const v1::Request&, int) { return Answers{}; });
  std::optional<CommandPool> pool(std::in_place, io_, endpoint_);
  pool->submit(stop(), [](const client::Result<v1::Response>&) { FAIL() << "nobody is to be told"; });
  ASSERT_TRUE(runs_until([&] { return daemon.requests() > 0; }));

  const auto before = Clock::now();
  pool.reset();

  EXPECT_LT(Clock::now() - before, std::chrono::seconds(15)) << "a stop may take 20 s";
}

}  // namespace
}  // namespace dts::gateway
