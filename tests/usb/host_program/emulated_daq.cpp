// SPDX-License-Identifier: Apache-2.0
#include "usb/host_program/emulated_daq.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "usb/emulator/fs_plus_emulator.h"
#include "usb/emulator/u6_emulator.h"
#include "usb/emulator/usb1608g_emulator.h"

namespace dts::emulator {
namespace {

constexpr std::array<std::pair<std::string_view, FsPlusKind>, 7> kFsPlusNames{{{"1608fs-plus", FsPlusKind::Usb1608},
                                                                               {"1208fs-plus", FsPlusKind::Usb1208},
                                                                               {"1408fs-plus", FsPlusKind::Usb1408},
                                                                               {"usb-201", FsPlusKind::Usb201},
                                                                               {"usb-202", FsPlusKind::Usb202},
                                                                               {"usb-204", FsPlusKind::Usb204},
                                                                               {"usb-205", FsPlusKind::Usb205}}};
constexpr std::uint16_t kUsb1608gRevision2 = 0x0134;
constexpr const char* kAnySerial = "01D4E5F6";

template <class Emulator>
EmulatedDaq with_faults(std::unique_ptr<Emulator> emulator) {
  Faults* faults = &emulator->faults;
  return {.device = std::move(emulator), .faults = faults};
}

}  // namespace

core::Result<EmulatedDaq> create_daq(std::string_view name, const std::string& serial, Source source) {
  const auto found = std::find_if(kFsPlusNames.begin(), kFsPlusNames.end(), [name](const auto& entry) { return entry.first == name; });
  if (found != kFsPlusNames.end()) {
    auto emulator = std::make_unique<FsPlusEmulator>(found->second, serial.empty() ? kAnySerial : serial, std::move(source));
    FsPlusEmulator* const wired = emulator.get();
    EmulatedDaq daq = with_faults(std::move(emulator));
    daq.loop_back = [wired](unsigned bit, std::size_t input) { wired->loop_back(bit, input); };
    return daq;
  }
  if (name == "1608g")
    return with_faults(std::make_unique<Usb1608gEmulator>(kUsb1608gRevision2, serial.empty() ? kAnySerial : serial, std::move(source)));
  if (name == "u6") {
    U6Emulator::Identity identity;
    if (!serial.empty()) identity.serial = static_cast<std::uint32_t>(std::strtoul(serial.c_str(), nullptr, 10));
    return with_faults(std::make_unique<U6Emulator>(std::move(source), identity));
  }
  std::string names = "u6, 1608g";
  for (const auto& entry : kFsPlusNames) names += ", " + std::string(entry.first);
  return core::fail(core::ErrorCode::InvalidArgument, "no emulated DAQ is called \"" + std::string(name) + "\"", "there are: " + names);
}

namespace {

constexpr std::array<std::pair<std::string_view, std::uint64_t Faults::*>, 9> kAtCode{
    {{"drop_code_at", &Faults::drop_code_at},
     {"drop_packet_at_code", &Faults::drop_packet_at_code},
     {"silence_at_code", &Faults::silence_at_code},
     {"stall_at_code", &Faults::stall_at_code},
     {"overrun_at_code", &Faults::overrun_at_code},
     {"short_packet_at_code", &Faults::short_packet_at_code},
     {"babble_at_code", &Faults::babble_at_code},
     {"corrupt_at_code", &Faults::corrupt_at_code},
     {"skip_counter_at_code", &Faults::skip_counter_at_code}}};

}  // namespace

std::string fault_names() {
  std::string names;
  for (const auto& [name, place] : kAtCode) names += std::string(name) + ", ";
  return names + "calibration_bytes, is_calibration_garbage, silent_control_requests, is_mute, clock_error_ppm, rate_factor";
}

bool set_fault(Faults& faults, std::string_view name, double value) {
  const auto code = static_cast<std::uint64_t>(std::clamp(value, 0.0, 1e18));
  const auto found = std::find_if(kAtCode.begin(), kAtCode.end(), [name](const auto& entry) { return entry.first == name; });
  if (found != kAtCode.end())
    faults.*(found->second) = code;
  else if (name == "calibration_bytes")
    faults.calibration_bytes = static_cast<std::size_t>(code);
  else if (name == "is_calibration_garbage")
    faults.is_calibration_garbage = value != 0.0;
  else if (name == "silent_control_requests")
    faults.silent_control_requests = static_cast<int>(std::clamp(value, 0.0, 1e6));
  else if (name == "is_mute")
    faults.is_mute = value != 0.0;
  else if (name == "clock_error_ppm")
    faults.clock_error_ppm = value;
  else if (name == "rate_factor")
    faults.rate_factor = value;
  else
    return false;
  return true;
}

}  // namespace dts::emulator
