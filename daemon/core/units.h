// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>

namespace dts::core {

/// A double with a unit: values of different units cannot be mixed. Sample columns are plain doubles, with the unit in the name.
template <class Unit>
struct Quantity {
  double value = 0.0;

  friend constexpr auto operator<=>(const Quantity&, const Quantity&) = default;
  friend constexpr Quantity operator+(Quantity a, Quantity b) noexcept { return {a.value + b.value}; }
  friend constexpr Quantity operator-(Quantity a, Quantity b) noexcept { return {a.value - b.value}; }
  friend constexpr Quantity operator*(Quantity a, double factor) noexcept { return {a.value * factor}; }
  friend constexpr Quantity operator*(double factor, Quantity a) noexcept { return {a.value * factor}; }
  friend constexpr Quantity operator/(Quantity a, double divisor) noexcept { return {a.value / divisor}; }
  friend constexpr double operator/(Quantity a, Quantity b) noexcept { return a.value / b.value; }
};

using Volts = Quantity<struct VoltsUnit>;
using Millimetres = Quantity<struct MillimetresUnit>;
using Newtons = Quantity<struct NewtonsUnit>;

/// Number of a scan in its segment, from 0. 64 bits: never wraps in practice.
struct ScanIndex {
  std::uint64_t value = 0;

  friend constexpr auto operator<=>(const ScanIndex&, const ScanIndex&) = default;
  friend constexpr ScanIndex operator+(ScanIndex index, std::uint64_t scans) noexcept { return {index.value + scans}; }
  /// Returns the number of scans from `b` to `a`; `a` must not be before `b`.
  friend constexpr std::uint64_t operator-(ScanIndex a, ScanIndex b) noexcept { return a.value - b.value; }
};

}  // namespace dts::core
