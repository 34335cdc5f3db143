// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/rate.h"
#include "core/result.h"
#include "device/mcc/control.h"
#include "device/usb/usb_bus.h"

namespace dts::device::mcc {

/// The form of AInScanStart (request 0x11).
///
///     TenBytes       count:u32 period:u32 mask options                      1608FS-Plus
///     FourteenBytes  count:u32 retrigger:u32 period:u32 mask options        1208FS-Plus, 1408FS-Plus
///     TwelveBytes    count:u32 period:u32 mask options trigger:u8 mode:u8   USB-20x
enum class StartForm : std::uint8_t { TenBytes, FourteenBytes, TwelveBytes };

/// One product of the family. Sources: uldaq 1.2.1 (AiUsb1608fsPlus, AiUsb1208fsPlus, AiUsb20x), Linux_Drivers by W. Jasper.
struct FsPlusModel {
  usb::UsbModel usb;
  unsigned bits = 16;
  std::int64_t clock_hz = 0;     ///< Clock of the pacer.
  bool is_simultaneous = false;  ///< true: one converter per input, a period is one scan. false: a period is one conversion.
  double max_scan_hz = 0.0;
  double max_aggregate_hz = 0.0;  ///< Scans per second times channels.
  std::size_t fifo_codes = 0;
  StartForm start = StartForm::TenBytes;
  bool has_range_list = false;  ///< AInConfig (request 0x14).
  bool has_sync_pin = false;
  LineDirection line_direction = LineDirection::PerLine;
  bool often_fails_first_start = false;  ///< USB-204: Linux_Drivers issue #42.
  std::span<const double> ranges_v;      ///< Single-ended, +- this value; the default first.
  std::span<const std::uint8_t> range_codes;
  std::size_t first_record = 0;       ///< Calibration record of range code 0, input 0.
  std::size_t records_per_range = 0;  ///< 0: all ranges share the same records.

  [[nodiscard]] std::uint16_t largest_code() const noexcept { return static_cast<std::uint16_t>((1U << bits) - 1U); }
  [[nodiscard]] std::uint8_t range_code(double range_v) const noexcept;
};

inline constexpr std::size_t kFsPlusInputs = 8;

/// Returns the family, one row per product.
[[nodiscard]] std::span<const FsPlusModel> fs_plus_models() noexcept;
/// Returns the row of the USB-1608FS-Plus.
[[nodiscard]] const FsPlusModel& usb_1608fs_plus() noexcept;

[[nodiscard]] double largest_scan_hz(const FsPlusModel& model, std::size_t channels) noexcept;

/// Register of the pacer, and its rate: clock / ((register + 1) * conversions per scan).
struct Pacing {
  std::uint32_t period = 0;  ///< Value of the register.
  core::Rate rate;           ///< Exact rate with this value.
};
/// Rounds the register to the nearest value. `wanted` must be within the limits.
[[nodiscard]] Pacing pace(std::int64_t clock_hz, std::size_t conversions_per_scan, core::Rate wanted) noexcept;
[[nodiscard]] Pacing pace(const FsPlusModel& model, std::size_t channels, core::Rate wanted) noexcept;

enum class Trigger : std::uint8_t { None = 0, Rising = 1, Falling = 2, High = 3, Low = 4 };
enum class SyncPin : std::uint8_t {
  Unused,
  Output,  ///< One pulse per scan.
  Input,   ///< One scan per rising edge; the period is not used.
};

struct StartCommand {
  std::uint32_t period = 0;
  std::uint8_t mask = 0;
  bool is_immediate = false;
  Trigger trigger = Trigger::None;
  SyncPin sync = SyncPin::Unused;
};

/// Returns the bytes that start an endless scan. "Do not stall on overrun" is off: see the README of this folder.
[[nodiscard]] std::vector<std::uint8_t> encode_start(StartForm form, const StartCommand& command);

}  // namespace dts::device::mcc
