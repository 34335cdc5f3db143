// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/shared_work.h"

#include <gtest/gtest.h>

#include <boost/asio/executor_work_guard.hpp>
#include <chrono>
#include <new>
#include <optional>

namespace dts::gateway {
namespace {

TEST(SharedWork, WhatThrowsIsAnErrorForWhoAskedAndTheNextIsMade) {
  boost::asio::io_context io;
  const auto keep_running = boost::asio::make_work_guard(io);
  Worker worker(io);
  SharedWork<int> work(worker, [](const std::string&, int) {});
  std::optional<core::Result<int>> first;
  std::optional<core::Result<int>> second;

  ASSERT_TRUE(work.ask(
      "large", [](const std::stop_token&) -> core::Result<int> { throw std::bad_alloc(); }, [&](const auto& made) { first = made; }));
  ASSERT_TRUE(work.ask(
      "small", [](const std::stop_token&) -> core::Result<int> { return 7; }, [&](const auto& made) { second = made; }));
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!second && io.run_one_until(deadline) > 0) {
  }

  ASSERT_TRUE(first && second);
  EXPECT_FALSE(first->has_value());
  EXPECT_EQ(second->value_or(0), 7);
}

}  // namespace
}  // namespace dts::gateway
