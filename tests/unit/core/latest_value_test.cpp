// SPDX-License-Identifier: Apache-2.0
#include "core/latest_value.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <thread>

namespace dts::core {
namespace {

TEST(LatestValue, NothingStored_IsTheInitialValue) {
  LatestValue<int> value(7);

  EXPECT_EQ(value.load(), 7);
  EXPECT_EQ(value.load(), 7);
  EXPECT_EQ(LatestValue<int>{}.load(), 0);
}

TEST(LatestValue, StoredSeveralTimes_IsTheNewest) {
  LatestValue<int> value;
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i <= round; ++i) value.store(100 * round + i);

    EXPECT_EQ(value.load(), 101 * round);
  }
}

TEST(LatestValue, LoadedReference_KeepsItsValueUntilTheNextLoad) {
  LatestValue<int> value;
  value.store(1);
  const int& loaded = value.load();

  value.store(2);
  value.store(3);
  value.store(4);

  EXPECT_EQ(loaded, 1);
  EXPECT_EQ(value.load(), 4);
}

TEST(LatestValue, TwoThreads_ReaderSeesWholeValuesThatNeverGoBack) {
  using Value = std::array<std::uint64_t, 16>;
  constexpr std::uint64_t kStores = 100'000;
  LatestValue<Value> latest;

  std::thread writer([&latest] {
    for (std::uint64_t i = 1; i <= kStores; ++i) {
      Value value;
      value.fill(i);
      latest.store(value);
    }
  });
  for (std::uint64_t newest = 0; newest < kStores;) {  // ends: the last value stored is seen in the end
    const Value& value = latest.load();
    ASSERT_EQ(std::ranges::count(value, value[0]), 16) << "torn";
    ASSERT_GE(value[0], newest);
    newest = value[0];
  }
  writer.join();
}

}  // namespace
}  // namespace dts::core
