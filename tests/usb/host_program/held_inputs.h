// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <mutex>
#include <random>
#include <vector>

#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// Inputs of an emulated DAQ that stay at the voltages that were set last; at first, and beyond those, at 0 V. Thread: any.
class HeldInputs {
 public:
  /// For an emulated device; this object outlives it.
  [[nodiscard]] Source source();
  void set(std::vector<double> volts);

 private:
  void fill(std::span<double> volts);

  std::mutex mutex_;
  std::vector<double> held_v_;
  std::mt19937 random_{1};  // NOLINT(cert-msc51-cpp): the same noise in every run is wanted
  std::normal_distribution<double> noise_v_{0.0, 3e-4};
};

}  // namespace dts::emulator
