// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "device/sim/counter_random.h"

namespace dts::device::sim {

struct DaqParameters {
  double range_v = 5.0;   ///< Converts -range_v .. +range_v.
  int bits = 11;          ///< Codes over the whole range: 2^bits. Thesis rig: 11 bit, +-5 V.
  double noise_v = 3e-3;  ///< Deviation of white noise before the converter, per scan and channel.
  std::uint64_t seed = 1;
};

/// The converter of a DAQ: adds noise, limits to the range, rounds to codes. Thread: any. Realtime-safe: yes.
class Daq {
 public:
  explicit Daq(const DaqParameters& parameters) noexcept;

  /// One code, V.
  [[nodiscard]] double step_v() const noexcept { return step_v_; }
  [[nodiscard]] double minimum_v() const noexcept { return minimum_v_; }
  /// One code below +range_v: two's complement has no code for it.
  [[nodiscard]] double maximum_v() const noexcept { return maximum_v_; }

  /// Replaces ideal voltages by what the converter says of them; depends on the seed, the scan and the position only.
  void convert(std::span<double> volts, std::uint64_t scan) const noexcept;

 private:
  [[nodiscard]] double to_code_v(double volts) const noexcept;

  CounterRandom random_;
  double noise_v_;
  double step_v_;
  double minimum_v_;
  double maximum_v_;
};

}  // namespace dts::device::sim
