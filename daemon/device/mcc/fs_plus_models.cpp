// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/fs_plus_models.h"

#include <algorithm>
#include <array>

#include "device/mcc/description.h"

namespace dts::device::mcc {
namespace {

__extension__ using Wide = __int128;

constexpr std::array kFourRangesV = {5.0, 10.0, 2.0, 1.0};
constexpr std::array<std::uint8_t, 4> kFourRangeCodes = {1, 0, 3, 5};
constexpr std::array kTenVolts = {10.0};
constexpr std::array<std::uint8_t, 1> kTenVoltsCode = {0};

constexpr FsPlusModel kUsb1608 = {.usb = {kVendor, 0x00EA, "USB-1608FS-Plus", "mcc:1608fs-plus"},
                                  .bits = 16,
                                  .clock_hz = 40'000'000,
                                  .is_simultaneous = true,
                                  .max_scan_hz = 100e3,
                                  .max_aggregate_hz = 400e3,
                                  .fifo_codes = 32'768,
                                  .start = StartForm::TenBytes,
                                  .has_range_list = true,
                                  .has_sync_pin = true,
                                  .ranges_v = kFourRangesV,
                                  .range_codes = kFourRangeCodes,
                                  .first_record = 0,
                                  .records_per_range = 8};

/// One converter behind a multiplexer, +-10 V single-ended; the records of the differential ranges come first.
constexpr FsPlusModel multiplexed(std::uint16_t product, std::string_view name, std::string_view uri, unsigned bits, double max_hz) {
  return {.usb = {kVendor, product, name, uri},
          .bits = bits,
          .clock_hz = 60'000'000,
          .max_scan_hz = max_hz,
          .max_aggregate_hz = max_hz,
          .fifo_codes = 8'192,
          .start = StartForm::FourteenBytes,
          .has_range_list = true,
          .line_direction = LineDirection::PerPort,  // uldaq: src/usb/dio/DioUsb1208fsPlus.cpp
          .ranges_v = kTenVolts,
          .range_codes = kTenVoltsCode,
          .first_record = 32};
}

constexpr FsPlusModel usb_20x(std::uint16_t product, std::string_view name, std::string_view uri, double max_hz,
                              bool often_fails_first_start) {
  return {.usb = {kVendor, product, name, uri},
          .bits = 12,
          .clock_hz = 70'000'000,
          .max_scan_hz = max_hz,
          .max_aggregate_hz = max_hz,
          .fifo_codes = 6'144,
          .start = StartForm::TwelveBytes,
          .often_fails_first_start = often_fails_first_start,
          .ranges_v = kTenVolts,
          .range_codes = kTenVoltsCode};
}

constexpr std::array kModels = {
    kUsb1608,
    multiplexed(0x00E8, "USB-1208FS-Plus", "mcc:1208fs-plus", 12, 52e3),
    multiplexed(0x00E9, "USB-1408FS-Plus", "mcc:1408fs-plus", 14, 48e3),
    usb_20x(0x0113, "USB-201", "mcc:usb-201", 100e3, false),
    usb_20x(0x012B, "USB-202", "mcc:usb-202", 100e3, false),
    usb_20x(0x0114, "USB-204", "mcc:usb-204", 500e3, true),
    usb_20x(0x012C, "USB-205", "mcc:usb-205", 500e3, true),
};

constexpr unsigned kImmediate = 1U << 0;
constexpr unsigned kSyncOutput = 1U << 1;  // on multiplexed models this bit means differential inputs
constexpr unsigned kTriggerShift = 2;

}  // namespace

std::uint8_t FsPlusModel::range_code(double range_v) const noexcept {
  const auto found = std::find(ranges_v.begin(), ranges_v.end(), range_v);
  return found == ranges_v.end() ? range_codes.front() : range_codes[static_cast<std::size_t>(found - ranges_v.begin())];
}

std::span<const FsPlusModel> fs_plus_models() noexcept { return kModels; }

const FsPlusModel& usb_1608fs_plus() noexcept { return kModels.front(); }

double largest_scan_hz(const FsPlusModel& model, std::size_t channels) noexcept {
  return std::min(model.max_scan_hz, model.max_aggregate_hz / static_cast<double>(channels));
}

Pacing pace(std::int64_t clock_hz, std::size_t conversions_per_scan, core::Rate wanted) noexcept {
  const Wide per_second = Wide{wanted.numerator()} * static_cast<std::int64_t>(conversions_per_scan);
  const Wide ticks = (Wide{clock_hz} * wanted.denominator() + per_second / 2) / per_second;
  const auto period = static_cast<std::int64_t>(std::clamp<Wide>(ticks, 2, Wide{1} << 32U));  // register 0 means: external clock
  const auto rate = core::Rate::create(clock_hz, period * static_cast<std::int64_t>(conversions_per_scan));
  return {.period = static_cast<std::uint32_t>(period - 1), .rate = rate.value_or(wanted)};
}

Pacing pace(const FsPlusModel& model, std::size_t channels, core::Rate wanted) noexcept {
  return pace(model.clock_hz, model.is_simultaneous ? 1 : channels, wanted);
}

std::vector<std::uint8_t> encode_start(StartForm form, const StartCommand& command) {
  const bool is_ten = form == StartForm::TenBytes;
  unsigned options = command.is_immediate ? kImmediate : 0U;
  if (is_ten && command.sync == SyncPin::Output) options |= kSyncOutput;
  if (form != StartForm::TwelveBytes) options |= static_cast<unsigned>(command.trigger) << kTriggerShift;

  std::vector<std::uint8_t> bytes;
  append_u32(bytes, 0);                                        // number of scans: endless
  if (form == StartForm::FourteenBytes) append_u32(bytes, 0);  // no retrigger
  append_u32(bytes, command.sync == SyncPin::Input ? 0 : command.period);
  bytes.push_back(command.mask);
  bytes.push_back(static_cast<std::uint8_t>(options));
  if (form != StartForm::TwelveBytes) return bytes;
  const bool has_trigger = command.trigger != Trigger::None;
  bytes.push_back(has_trigger ? 1 : 0);
  bytes.push_back(has_trigger ? static_cast<std::uint8_t>(static_cast<unsigned>(command.trigger) - 1U) : 0);
  return bytes;
}

}  // namespace dts::device::mcc
