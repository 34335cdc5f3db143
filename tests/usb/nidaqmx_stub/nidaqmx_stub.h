// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>

namespace dts::emulator {

/// What a test tells the stand-in for NI's library, and what it sees of it. There is one device, "Dev1", with 8 inputs.
/// `nidaqmx_stub_control` of the library gives it; put a fresh one into it before each test.
struct NiStubControl {
  static constexpr std::uint64_t kNever = std::numeric_limits<std::uint64_t>::max();

  // Time: scans are there when `now_ns` says so; a read that waits calls `wait_until_ns`.
  std::function<std::int64_t()> now_ns;
  std::function<void(std::int64_t)> wait_until_ns;

  double runs_at_hz = 0.0;              ///< What the device makes of the rate that it is asked for; 0: just that.
  double timebase_hz = 0.0;             ///< Divided by a whole number, rounded down, as AI clocks are; 0: any rate can be had.
  bool is_triggered = true;             ///< The edge at the trigger input has come.
  std::uint64_t fail_at_read = kNever;  ///< From this read on, counted from 0, ...
  std::int32_t fail_status = 0;         ///< ... reads end with this.
  std::uint32_t serial_number = 0x1A2B3C4;
  bool is_present = true;              ///< The device is plugged in.
  std::int32_t start_status = 0;       ///< What DAQmxStartTask says.
  std::uint64_t nan_at_scan = kNever;  ///< Every channel of this scan is not a number.
  bool gives_too_many = false;         ///< Claims more scans than were asked for.

  int tasks = 0;  ///< Created and not cleared.
  int running = 0;
  std::uint64_t reads = 0;
  std::string channels;
  std::int32_t terminal = 0;
  double minimum = 0.0;
  double maximum = 0.0;
  double rate_hz = 0.0;
  std::uint64_t buffer_scans = 0;
  std::string trigger;
};

/// What the device converts: every value says which one it is.
[[nodiscard]] inline double ni_stub_volts(std::size_t position, std::uint64_t scan) {
  return static_cast<double>(position) - 4.0 + static_cast<double>(scan % 4096) / 8192.0;
}

}  // namespace dts::emulator

extern "C" dts::emulator::NiStubControl* nidaqmx_stub_control();
