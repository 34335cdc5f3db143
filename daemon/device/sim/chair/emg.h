// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "device/sim/chair/chair_options.h"
#include "physics/body/reach_plan.h"

namespace dts::device::sim {

/// The muscles of thesis 6.3.2, E1 to E6: triceps, biceps, anterior and posterior deltoid, right and left erector spinae.
inline constexpr std::array<std::string_view, kEmgChannels> kEmgNames = {"emg_tr", "emg_bi", "emg_ad", "emg_pd", "emg_res", "emg_les"};

/// Voltages like those of amplified surface electrodes: noise between 25 and 400 Hz under envelopes that follow a reach. Biceps and
/// anterior deltoid lift the arm, slightly before it moves; the erectors of the spine brake the trunk from the end of the initiation
/// stage on (thesis 6.4.1) and are tonic when it does not move. Shapes and sizes are assumptions. Thread: any. Realtime-safe: yes.
class Emg {
 public:
  explicit Emg(std::uint64_t seed) noexcept;

  /// `reach`: under way or next; nullptr: none. `values` has room for every channel; V.
  void write(double time_s, bool is_there, const physics::ReachPlan* reach, std::span<double> values) const noexcept;

 private:
  static constexpr std::size_t kWaves = 10;
  struct Wave {
    double hz = 0.0;
    double phase = 0.0;
  };

  std::array<std::array<Wave, kWaves>, kEmgChannels> waves_{};
};

}  // namespace dts::device::sim
