// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <istream>
#include <string>

#include "usb/host_program/bus.h"
#include "usb/host_program/emulated_daq.h"
#include "usb/host_program/held_inputs.h"
#include "usb/host_program/rig_source.h"

namespace dts::emulator {

/// What can be asked for while the program runs, one line each:
///
///     plug | unplug | replug           fault NAME VALUE (names of Faults)        quit
///     truth [MONOTONIC_NS]             answers "ok ml_mm ap_mm load_n", now or at a host time; nan: nobody there
///     story                            answers "ok SECONDS" since the scene began
///     hold VOLTS VOLTS ...             inputs 0, 1, ... from now on, if no scene is wired to them
class Commands {
 public:
  /// What is wired to the DAQ: either `rig` or `held`; the other one is nullptr.
  Commands(Bus& bus, EmulatedDaq& daq, RigSource* rig, HeldInputs* held) : bus_(bus), daq_(daq), rig_(rig), held_(held) {}

  /// The answer, one line that begins with "ok" or "error".
  [[nodiscard]] std::string run(const std::string& line);
  [[nodiscard]] bool wants_to_quit() const noexcept { return wants_to_quit_; }

 private:
  [[nodiscard]] std::string plug();
  [[nodiscard]] std::string truth(const std::string& monotonic_ns);
  [[nodiscard]] std::string hold(std::istream& volts);

  Bus& bus_;
  EmulatedDaq& daq_;
  RigSource* rig_;
  HeldInputs* held_;
  core::SystemClock clock_;
  bool wants_to_quit_ = false;
};

}  // namespace dts::emulator
