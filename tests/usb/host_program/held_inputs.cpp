// SPDX-License-Identifier: Apache-2.0
#include "usb/host_program/held_inputs.h"

#include <utility>

namespace dts::emulator {

Source HeldInputs::source() {
  return [this](double, std::span<double> volts) { fill(volts); };
}

void HeldInputs::set(std::vector<double> volts) {
  const std::lock_guard lock(mutex_);
  held_v_ = std::move(volts);
}

void HeldInputs::fill(std::span<double> volts) {
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < volts.size(); ++i) volts[i] = (i < held_v_.size() ? held_v_[i] : 0.0) + noise_v_(random_);
}

}  // namespace dts::emulator
