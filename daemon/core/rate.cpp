// SPDX-License-Identifier: Apache-2.0
#include "core/rate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/clock.h"

namespace dts::core {
namespace {

__extension__ using Wide = __int128;  // index * 1e9 * denominator exceeds 64 bits after three hours at 1500 Hz

}  // namespace

Result<Rate> Rate::create(std::int64_t scans, std::int64_t seconds) {
  if (scans < 1 || seconds < 1 || scans > kMaxTerm || seconds > kMaxTerm) {
    return fail(ErrorCode::InvalidArgument,
                "rate " + std::to_string(scans) + "/" + std::to_string(seconds) + " Hz is not a positive fraction");
  }
  const std::int64_t divisor = std::gcd(scans, seconds);
  return Rate{scans / divisor, seconds / divisor};
}

Result<Rate> Rate::from_hz(double hz) {
  constexpr double kMicro = 1e6;
  if (!std::isfinite(hz) || hz * kMicro < 0.5 || hz > kMicro) {
    return fail(ErrorCode::InvalidArgument, "rate " + std::to_string(hz) + " Hz is outside (0, 1000000] Hz");
  }
  return create(std::llround(hz * kMicro), static_cast<std::int64_t>(kMicro));
}

std::int64_t Rate::time_ns(ScanIndex index) const noexcept {
  constexpr Wide kLatest = std::numeric_limits<std::int64_t>::max();
  const Wide scan_seconds = Wide{index.value} * seconds_;  // below 2^104
  if (scan_seconds > kLatest * scans_ / kNanosecondsPerSecond) return std::numeric_limits<std::int64_t>::max();
  return static_cast<std::int64_t>((scan_seconds * kNanosecondsPerSecond + scans_ / 2) / scans_);
}

std::uint64_t Rate::scans_in_ms(double ms) const noexcept {
  // With this order of arguments, std::max returns 1 for NaN.
  const double scans = std::max(1.0, std::round(ms * 1e-3 * hz()));
  return static_cast<std::uint64_t>(std::min(scans, static_cast<double>(kMaxTerm)));
}

Rate Rate::divided_by(std::int64_t factor) const noexcept {
  const std::int64_t divisor = std::gcd(scans_, factor);
  return Rate{scans_ / divisor, seconds_ * (factor / divisor)};
}

}  // namespace dts::core
