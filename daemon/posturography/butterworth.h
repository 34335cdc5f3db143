// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace dts::posturography {

/// A second-order section: y = b0 x + z1, z1' = b1 x - a1 y + z2, z2' = b2 x - a2 y (transposed direct form II).
struct Section {
  double b0 = 1.0;
  double b1 = 0.0;
  double b2 = 0.0;
  double a1 = 0.0;
  double a2 = 0.0;
};
using LowPass = std::array<Section, 2>;

/// Returns a Butterworth low-pass of 4th order, bilinear with prewarping. 0 < cutoff_hz < rate_hz / 2. Thread: any.
[[nodiscard]] LowPass butterworth4(double cutoff_hz, double rate_hz) noexcept;

/// Returns the group delay of the low-pass near DC, in samples: 4.02 for 10 Hz at 100 Hz, 41.6 at 1000 Hz. Thread: any.
[[nodiscard]] double lag_near_dc(double cutoff_hz, double rate_hz) noexcept;

/// The low-pass, one sample at a time: -3 dB at the cut-off, delay 40 ms near DC for 10 Hz. Realtime-safe: yes.
class CausalLowPass {
 public:
  static constexpr std::size_t kStateSize = 4;

  explicit CausalLowPass(const LowPass& sections = {}) noexcept : sections_(sections) {}
  /// Sets the state that an infinite constant `value` would cause.
  void settle_at(double value) noexcept;
  [[nodiscard]] double step(double value) noexcept;
  [[nodiscard]] const std::array<double, kStateSize>& state() const noexcept { return state_; }
  void set_state(const std::array<double, kStateSize>& state) noexcept { state_ = state; }

 private:
  LowPass sections_;
  std::array<double, kStateSize> state_{};
};

/// Padding with odd reflection at both ends: 3 (order + 1).
inline constexpr std::size_t kZeroPhasePadding = 15;

/// Filters `values` in place, first forward, then backward. Each pass starts in the steady state of its first (padded) sample, like scipy's
/// filtfilt. Needs more than `kZeroPhasePadding` values, all finite; with fewer, changes nothing. Thread: any.
void filter_zero_phase(const LowPass& sections, std::span<double> values);

}  // namespace dts::posturography
