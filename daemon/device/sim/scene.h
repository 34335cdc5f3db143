// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/result.h"
#include "device/device.h"

namespace dts::device::sim {

/// What a simulated device measures: everything before the converter. The device owns time, blocks and faults; the scene
/// owns plate, sensors and person. Thread: as the device that owns it.
class Scene {
 public:
  virtual ~Scene() = default;

  /// Reads the files it needs; called by every open.
  [[nodiscard]] virtual core::Status load() = 0;
  /// Back to time 0, same story again; takes all memory. Called by every start.
  virtual void restart() = 0;
  /// Value of every channel at `time_s` of the device, in the channel's unit; ideal volts where a converter follows. NaN: there
  /// is no value (nobody on the plate). `time_s` never goes back between two restarts. Realtime-safe: yes.
  virtual void evaluate(double time_s, std::span<double> values) noexcept = 0;
  /// The person is told something at `time_s` of the device; between two evaluations. Realtime-safe: yes.
  virtual void hear(double time_s, const Cue& cue) noexcept {
    static_cast<void>(time_s);
    static_cast<void>(cue);
  }
};

}  // namespace dts::device::sim
