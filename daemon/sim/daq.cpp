// SPDX-License-Identifier: Apache-2.0
#include "sim/daq.h"

#include <algorithm>
#include <cmath>

#include "core/block.h"

namespace dts::sim {
namespace {

constexpr std::uint64_t kPairsPerScan = core::kMaxChannels / 2;

}  // namespace

Daq::Daq(const DaqParameters& parameters) noexcept
    : random_(parameters.seed),
      noise_v_(parameters.noise_v),
      step_v_(std::ldexp(2.0 * parameters.range_v, -parameters.bits)),
      minimum_v_(-parameters.range_v),
      maximum_v_(parameters.range_v - step_v_) {}

double Daq::to_code_v(double volts) const noexcept { return std::clamp(std::round(volts / step_v_) * step_v_, minimum_v_, maximum_v_); }

void Daq::convert(std::span<double> volts, std::uint64_t scan) const noexcept {
  if (noise_v_ == 0.0) {
    for (double& value : volts) value = to_code_v(value);
    return;
  }
  for (std::size_t i = 0; i < volts.size(); i += 2) {
    const auto [first, second] = random_.gaussian_pair(scan * kPairsPerScan + i / 2);
    volts[i] = to_code_v(volts[i] + noise_v_ * first);
    if (i + 1 < volts.size()) volts[i + 1] = to_code_v(volts[i + 1] + noise_v_ * second);
  }
}

}  // namespace dts::sim
