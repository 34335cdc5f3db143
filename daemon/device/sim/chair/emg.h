// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "device/sim/chair/chair_options.h"
#include "sim/reach_plan.h"

namespace dts::device::sim {

/// Muscles E1 to E6 of thesis 6.3.2: triceps, biceps, anterior and posterior deltoid, right and left erector spinae.
inline constexpr std::array<std::string_view, kEmgChannels> kEmgNames = {"emg_tr", "emg_bi", "emg_ad", "emg_pd", "emg_res", "emg_les"};

/// Voltages like those of amplified surface electrodes: noise between 25 and 400 Hz with envelopes that follow a reach. Biceps and
/// anterior deltoid lift the arm and are active slightly before it moves. The erectors of the spine brake the trunk from the end of the
/// initiation stage on (thesis 6.4.1) and have tonic activity otherwise. Shapes and amplitudes are assumptions.
/// Thread: any. Realtime-safe: yes.
class Emg {
 public:
  explicit Emg(std::uint64_t seed) noexcept;

  /// Writes the voltage of every channel, V, to `values`. `reach`: the current or next reach; nullptr: none.
  void write(double time_s, bool is_there, const dts::sim::ReachPlan* reach, std::span<double> values) const noexcept;

 private:
  static constexpr std::size_t kWaves = 10;
  struct Wave {
    double hz = 0.0;
    double phase = 0.0;
  };

  std::array<std::array<Wave, kWaves>, kEmgChannels> waves_{};
};

}  // namespace dts::device::sim
