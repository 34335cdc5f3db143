// SPDX-License-Identifier: Apache-2.0
#include "device/sim/pacer.h"

#include <cmath>

namespace dts::device::sim {

std::int64_t Pacer::instant_ns(std::uint64_t scan) const noexcept {
  const std::int64_t nominal_ns = rate_.time_ns({scan});
  return start_ns_ + nominal_ns - std::llround(static_cast<double>(nominal_ns) * clock_error_);
}

std::uint64_t Pacer::taken_by(std::int64_t now_ns) const noexcept {
  if (now_ns < start_ns_) return 0;
  const double elapsed_s = static_cast<double>(now_ns - start_ns_) * 1e-9 / (1.0 - clock_error_);
  // The estimate has only rounding errors; the loops make it agree exactly with instant_ns.
  auto count = static_cast<std::uint64_t>(elapsed_s * rate_.hz()) + 1;
  while (count > 0 && instant_ns(count - 1) > now_ns) --count;
  while (instant_ns(count) <= now_ns) ++count;
  return count;
}

}  // namespace dts::device::sim
