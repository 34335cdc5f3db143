// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "core/result.h"
#include "device/device.h"

namespace dts::device::sim {

/// The simulated signals before the converter. The device owns time, blocks and faults; the scene owns plate, sensors and person.
/// Thread: as the device that owns it.
class Scene {
 public:
  virtual ~Scene() = default;

  /// Reads the files that the scene needs; called by every open.
  [[nodiscard]] virtual core::Status load() = 0;
  /// Restarts the scene at time 0, with the same signals; allocates all memory. Called by every start.
  virtual void restart() = 0;
  /// Passes the host time of time 0; called by every start, after `restart`. Only a scene that shares its time with another device needs
  /// it.
  virtual void set_start(std::int64_t start_ns) { static_cast<void>(start_ns); }
  /// Writes the value of every channel at `time_s` of the device, in the channel's unit; ideal volts for converted channels. NaN:
  /// no value (no person on the plate). `time_s` never decreases between two restarts. Realtime-safe: yes.
  virtual void evaluate(double time_s, std::span<double> values) noexcept = 0;
  /// Passes a cue to the person at `time_s` of the device, between two evaluations. Realtime-safe: yes.
  virtual void hear(double time_s, const Cue& cue) noexcept {
    static_cast<void>(time_s);
    static_cast<void>(cue);
  }
};

}  // namespace dts::device::sim
