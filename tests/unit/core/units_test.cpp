// SPDX-License-Identifier: Apache-2.0
#include "core/units.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace dts::core {
namespace {

template <class A, class B>
concept Addable = requires(A a, B b) {
  a + b;
};
template <class A, class B>
concept Comparable = requires(A a, B b) {
  a == b;
};

static_assert(Addable<Volts, Volts>);
static_assert(!Addable<Volts, Millimetres>, "units do not mix");
static_assert(!Comparable<Newtons, Millimetres>);
static_assert(!std::is_convertible_v<double, Volts>, "a plain number has no unit");
static_assert(sizeof(Volts) == sizeof(double));

TEST(Quantity, Arithmetic_KeepsTheUnit) {
  constexpr Millimetres gap = Millimetres{3.0} + Millimetres{1.5} - Millimetres{0.5};

  EXPECT_EQ(gap, Millimetres{4.0});
  EXPECT_EQ(gap * 2.0, Millimetres{8.0});
  EXPECT_EQ(2.0 * gap, Millimetres{8.0});
  EXPECT_EQ(gap / 4.0, Millimetres{1.0});
  static_assert(std::is_same_v<decltype(gap / gap), double>, "a ratio has no unit");
  EXPECT_EQ(gap / Millimetres{2.0}, 2.0);
}

TEST(ScanIndex, Distance_CountsScans) {
  const ScanIndex first{1'000'000'000'000};

  EXPECT_EQ((first + 24) - first, 24U);
  EXPECT_EQ(first - first, 0U);
  EXPECT_LT(first, first + 1);
}

}  // namespace
}  // namespace dts::core
