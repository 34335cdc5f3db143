// SPDX-License-Identifier: Apache-2.0
#include "device/sim/chair/emg.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/counter_random.h"

namespace dts::device::sim {
namespace {

constexpr std::uint64_t kEmgSeed = 0x656d67ULL;
constexpr double kLowestHz = 25.0;
constexpr double kHighestHz = 400.0;
constexpr double kElectrodeV = 0.005;
constexpr double kTonicV = 0.03;
constexpr double kFullV = 0.5;
constexpr double kLeadS = 0.05;  // a muscle is active this long before its force moves the limb
constexpr double kRampS = 0.08;
constexpr double kDipPart = 0.22;  // part of the forward phase at which the transient has its first minimum

enum Muscle : std::size_t { kTriceps, kBiceps, kAnteriorDeltoid, kPosteriorDeltoid, kRightErector, kLeftErector };

/// Returns 1 between `from_s` and `to_s`, 0 outside, with ramps.
double burst(double time_s, double from_s, double to_s) noexcept {
  return dts::sim::smooth_step((time_s - from_s) / kRampS) * (1.0 - dts::sim::smooth_step((time_s - to_s) / kRampS));
}

using Envelopes = std::array<double, kEmgChannels>;

/// Returns the activity of each muscle, as a part of full activity.
Envelopes activity(double time_s, const dts::sim::ReachPlan& reach) noexcept {
  const double on_s = reach.on_s - kLeadS;
  const double stretch_s = reach.on_s + 0.5 * (reach.hit_s - reach.on_s);
  const double lifting = burst(time_s, on_s, reach.hit_s);
  const double holding = burst(time_s, reach.hit_s, reach.back_s);
  const double lowering = burst(time_s, reach.back_s, reach.end_s - kRampS);
  Envelopes result{};
  result[kTriceps] = 0.5 * burst(time_s, stretch_s, reach.back_s);
  result[kBiceps] = 0.8 * lifting + 0.5 * holding + 0.4 * lowering;
  result[kAnteriorDeltoid] = lifting + 0.7 * holding + 0.4 * lowering;
  result[kPosteriorDeltoid] = 0.15 * lifting + 0.4 * lowering;
  if (!reach.moves_trunk) return result;
  const double dip_end_s = reach.on_s + kDipPart * (reach.hit_s - reach.on_s);
  const double braking = std::sin(reach.trunk_deg * std::numbers::pi / 180.0) * burst(time_s, dip_end_s, reach.end_s - 2.0 * kRampS);
  result[kRightErector] = result[kLeftErector] = std::max(braking, 0.0);
  return result;
}

}  // namespace

Emg::Emg(std::uint64_t seed) noexcept {
  const dts::sim::CounterRandom random(seed ^ kEmgSeed);
  std::uint64_t next = 0;
  for (auto& channel : waves_) {
    for (Wave& wave : channel) {
      wave.hz = kLowestHz + (kHighestHz - kLowestHz) * random.uniform(next++);
      wave.phase = 2.0 * std::numbers::pi * random.uniform(next++);
    }
  }
}

void Emg::write(double time_s, bool is_there, const dts::sim::ReachPlan* reach, std::span<double> values) const noexcept {
  const Envelopes envelopes = is_there && reach != nullptr ? activity(time_s, *reach) : Envelopes{};
  for (std::size_t channel = 0; channel < std::min(values.size(), waves_.size()); ++channel) {
    double sum = 0.0;
    for (const Wave& wave : waves_[channel]) sum += std::sin(2.0 * std::numbers::pi * wave.hz * time_s + wave.phase);
    const double noise = sum * std::sqrt(2.0 / static_cast<double>(kWaves));  // standard deviation 1
    values[channel] = noise * (is_there ? kTonicV + kFullV * envelopes[channel] : kElectrodeV);
  }
}

}  // namespace dts::device::sim
