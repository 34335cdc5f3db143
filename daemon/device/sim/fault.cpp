// SPDX-License-Identifier: Apache-2.0
#include "device/sim/fault.h"

#include <algorithm>
#include <cmath>

namespace dts::device::sim {

FaultWindow fault_window(const Fault& fault, core::Rate rate) noexcept {
  if (fault.kind == FaultKind::None) return {};
  constexpr double kRoundingScans = 1e-6;  // 2.3 s at 100 Hz is scan 230, although rounding makes 2.3 * 100 slightly different
  const auto first_scan_at = [rate](double time_s) { return static_cast<std::uint64_t>(std::ceil(time_s * rate.hz() - kRoundingScans)); };
  const std::uint64_t first = first_scan_at(fault.at_s);
  return {first, std::max(first + 1, first_scan_at(fault.at_s + fault.for_s))};
}

}  // namespace dts::device::sim
