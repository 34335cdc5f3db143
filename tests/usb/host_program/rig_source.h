// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/result.h"
#include "device/sim/floor.h"
#include "physics/rig_model.h"
#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// The sensors of a simulated platform wired to the inputs of an emulated DAQ: sensor n to input n, all other inputs grounded. One
/// story in the machine's time from the moment it is made, however often a scan is started. Thread: any.
class RigSource {
 public:
  struct Truth {
    double ml_mm = 0.0;  ///< NaN: nobody is on the plate.
    double ap_mm = 0.0;
    double load_n = 0.0;
  };

  /// `rig_file`: plate and sensors; `scene`: a "sim:floor?..." URI. Fails naming the file or the option.
  [[nodiscard]] static core::Result<std::unique_ptr<RigSource>> create(const std::string& rig_file, const std::string& scene);

  /// For an emulated device; this object outlives it.
  [[nodiscard]] Source source();
  [[nodiscard]] std::int64_t start_ns() const noexcept { return start_ns_; }
  /// What stood on the plate at a monotonic time.
  [[nodiscard]] Truth truth_at(std::int64_t monotonic_ns);

 private:
  RigSource() = default;
  void fill(double time_s, std::span<double> volts);
  [[nodiscard]] double story_s(double time_s);

  std::mutex mutex_;
  core::SystemClock clock_;
  physics::RigModel rig_;
  device::sim::FloorScene seen_;   ///< By the DAQ.
  device::sim::FloorScene known_;  ///< By whoever asks for the truth: time may go back.
  std::vector<double> values_;
  std::int64_t start_ns_ = 0;
  double offset_s_ = 0.0;  ///< Story time minus the device's.
  double device_s_ = 0.0;  ///< Newest time of the device.
  double latest_s_ = 0.0;
  double latest_truth_s_ = 0.0;
  std::mt19937 random_{1};  // NOLINT(cert-msc51-cpp): the same noise in every run is wanted
  std::normal_distribution<double> noise_v_{0.0, 1e-3};
};

}  // namespace dts::emulator
