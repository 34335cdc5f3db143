// SPDX-License-Identifier: Apache-2.0
#include "gateway/archive/shared_work.h"

#include <new>
#include <optional>

#include "unit/gateway/answered_test.h"

namespace dts::gateway {
namespace {

using SharedWorkTest = IoTest;

TEST_F(SharedWorkTest, WhatThrowsIsAnErrorForWhoAskedAndTheNextIsMade) {
  Worker worker(io_);
  SharedWork<int> work([](const std::string&, int) {});
  std::optional<core::Result<int>> first;
  std::optional<core::Result<int>> second;

  ASSERT_TRUE(work.ask(
      worker, "large", [](const std::stop_token&) -> core::Result<int> { throw std::bad_alloc(); },
      [&](const auto& made) { first = made; }));
  ASSERT_TRUE(work.ask(
      worker, "small", [](const std::stop_token&) -> core::Result<int> { return 7; }, [&](const auto& made) { second = made; }));

  ASSERT_TRUE(runs_until([&] { return first && second; }));
  EXPECT_FALSE(first->has_value());
  EXPECT_EQ(second->value_or(0), 7);
}

}  // namespace
}  // namespace dts::gateway
