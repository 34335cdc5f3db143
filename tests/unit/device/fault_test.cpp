// SPDX-License-Identifier: Apache-2.0
#include "device/sim/fault.h"

#include <gtest/gtest.h>

namespace dts::device::sim {
namespace {

TEST(FaultWindow, SecondsBecomeScans_AtLeastOneAndWithoutRoundingErrors) {
  const auto window_of = [](const Fault& fault) { return fault_window(fault, *core::Rate::create(100, 1)); };
  EXPECT_FALSE(window_of({}).contains(0));
  EXPECT_FALSE(window_of({}).contains(1'000'000));
  EXPECT_EQ(window_of({FaultKind::Stuck, 2.3, 0.7, 0}).first, 230U);
  EXPECT_EQ(window_of({FaultKind::Stuck, 2.3, 0.7, 0}).end, 300U);
  EXPECT_EQ(window_of({FaultKind::Stuck, 0.0, 0.001, 0}).first, 0U);
  EXPECT_EQ(window_of({FaultKind::Stuck, 0.0, 0.001, 0}).end, 1U);
}

}  // namespace
}  // namespace dts::device::sim
