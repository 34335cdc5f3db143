// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "sim/counter_random.h"

namespace dts::sim {

struct DaqParameters {
  double range_v = 5.0;   ///< Range of the converter: -range_v .. +range_v.
  int bits = 11;          ///< The whole range has 2^bits codes. Thesis rig: 11 bits, +-5 V.
  double noise_v = 3e-3;  ///< Standard deviation of the white noise before the converter, per scan and channel.
  std::uint64_t seed = 1;
};

/// The converter of a DAQ: adds noise, limits to the range, rounds to codes. Thread: any. Realtime-safe: yes.
class Daq {
 public:
  explicit Daq(const DaqParameters& parameters) noexcept;

  /// Returns the size of one code, V.
  [[nodiscard]] double step_v() const noexcept { return step_v_; }
  [[nodiscard]] double minimum_v() const noexcept { return minimum_v_; }
  /// Returns one code less than +range_v: two's complement has no code for +range_v.
  [[nodiscard]] double maximum_v() const noexcept { return maximum_v_; }

  /// Replaces ideal voltages by converted voltages; the noise depends only on the seed, the scan and the channel.
  void convert(std::span<double> volts, std::uint64_t scan) const noexcept;

 private:
  [[nodiscard]] double to_code_v(double volts) const noexcept;

  CounterRandom random_;
  double noise_v_;
  double step_v_;
  double minimum_v_;
  double maximum_v_;
};

}  // namespace dts::sim
