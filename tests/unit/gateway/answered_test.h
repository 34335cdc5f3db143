// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <utility>
#include <vector>

#include "gateway/http/http_message.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::gateway {

/// For tests on an io context that the test runs.
class IoTest : public ::testing::Test {
 protected:
  /// Runs until it holds, or too long.
  template <class Condition>
  [[nodiscard]] bool runs_until(const Condition& condition) {
    const auto deadline = std::chrono::steady_clock::now() + testing::kDeadline;
    while (!condition() && std::chrono::steady_clock::now() < deadline) io_.run_one_for(std::chrono::milliseconds(10));
    return condition();
  }

  boost::asio::io_context io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> keep_running_{io_.get_executor()};
};

/// For tests of what answers requests later.
class AnsweredTest : public IoTest {
 protected:
  /// Keeps the answer for `wait_for`.
  [[nodiscard]] Respond keep() {
    return [this](HttpResponse answer) { answers_.push_back(std::move(answer)); };
  }
  std::vector<HttpResponse> wait_for(std::size_t count) {
    EXPECT_TRUE(runs_until([&] { return answers_.size() >= count; }));
    EXPECT_EQ(answers_.size(), count);
    answers_.resize(count);
    return std::exchange(answers_, {});
  }

  std::vector<HttpResponse> answers_;
};

}  // namespace dts::gateway
