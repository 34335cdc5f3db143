// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <numeric>

#include "core/result.h"
#include "core/units.h"

namespace dts::core {

/// Scans per second as an exact fraction. A DAQ divides its clock, so its true rate is rational and rarely the requested rate.
/// Times computed from index and rate must not drift by rounding (design: "never the requested rate").
class Rate {
 public:
  static constexpr std::int64_t kMaxTerm = 1'000'000'000'000;

  constexpr Rate() = default;  ///< 1 Hz.

  /// Makes the rate scans / seconds. Fails with InvalidArgument unless both terms are in [1, kMaxTerm].
  [[nodiscard]] static Result<Rate> create(std::int64_t scans, std::int64_t seconds);
  /// Returns the fraction nearest to `hz`, with 1e-6 Hz resolution. Fails with InvalidArgument unless `hz` is finite and in (0, 1e6].
  [[nodiscard]] static Result<Rate> from_hz(double hz);

  [[nodiscard]] constexpr std::int64_t numerator() const noexcept { return scans_; }
  [[nodiscard]] constexpr std::int64_t denominator() const noexcept { return seconds_; }
  [[nodiscard]] constexpr double hz() const noexcept { return static_cast<double>(scans_) / static_cast<double>(seconds_); }

  /// Returns the time from scan 0 to `index`, rounded to the nearest ns; exact arithmetic, no accumulated error. Saturates at the
  /// largest value (292 years).
  [[nodiscard]] std::int64_t time_ns(ScanIndex index) const noexcept;
  /// Returns the nearest number of whole scans in `ms` milliseconds, limited to 1 .. kMaxTerm for any `ms`.
  [[nodiscard]] std::uint64_t scans_in_ms(double ms) const noexcept;
  /// Returns this rate divided by an integer factor (for a stage that outputs every n-th scan). `factor` must be in [1, 1e6].
  [[nodiscard]] Rate divided_by(std::int64_t factor) const noexcept;

  friend constexpr bool operator==(const Rate&, const Rate&) = default;

 private:
  constexpr Rate(std::int64_t scans, std::int64_t seconds) noexcept : scans_(scans), seconds_(seconds) {}

  std::int64_t scans_ = 1;
  std::int64_t seconds_ = 1;
};

}  // namespace dts::core
