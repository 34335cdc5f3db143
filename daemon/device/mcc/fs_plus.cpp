// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/fs_plus.h"

#include <algorithm>
#include <array>
#include <utility>

#include "device/device_checks.h"
#include "device/mcc/control.h"
#include "device/mcc/description.h"
#include "device/mcc/transfer_choice.h"

namespace dts::device::mcc {
namespace {

using core::ErrorCode;

constexpr std::uint8_t kDataEndpoint = 0x81;

// Vendor requests (uldaq: src/usb/ai/AiUsb1608fsPlus.h; Linux_Drivers: usb-1608FS-Plus.c).
constexpr std::uint8_t kReadInput = 0x10;
constexpr std::uint8_t kScanStart = 0x11;
constexpr std::uint8_t kScanStop = 0x12;
constexpr std::uint8_t kRangeList = 0x14;
constexpr std::uint8_t kClearFifo = 0x15;
constexpr std::uint8_t kCalibrationMemory = 0x30;
constexpr std::uint8_t kStatus = 0x44;  // writing it clears its error bits

constexpr unsigned kScanRunning = 1U << 1;
constexpr unsigned kScanOverrun = 1U << 2;

constexpr std::size_t kMemoryPieceBytes = 256;  // as uldaq
constexpr char kOtherProgramHint[] = "close any other program that uses the device";

std::uint8_t mask_of(std::span<const std::size_t> channels) {
  unsigned mask = 0;
  for (const std::size_t channel : channels) mask |= 1U << channel;
  return static_cast<std::uint8_t>(mask);
}

}  // namespace

FsPlus::FsPlus(const FsPlusModel& model, FsPlusSettings settings)
    : model_(model),
      settings_(std::move(settings)),
      description_(
          describe_unit(model.usb.name, settings_.options, model.bits, largest_scan_hz(model, settings_.options.channels.size()))) {
  for (const double range_v : settings_.options.ranges_v) lines_.push_back(voltage_line({}, range_v, model_.bits));
  description_.has_sync_output = settings_.sync_output_bit.has_value();
  command_.mask = mask_of(settings_.options.channels);
  command_.trigger = settings_.trigger;
  command_.sync = settings_.sync;
}

core::Result<core::Rate> FsPlus::exact_rate(core::Rate wanted) const {
  const auto checked = check_rate(description_, wanted);
  if (!checked) return checked;
  return pace(model_, settings_.options.channels.size(), wanted).rate;
}

core::Status FsPlus::connect(usb::UsbPort& port, std::vector<DeviceCheck>& checks) {
  DTS_TRY(put(port, {.request = kScanStop}, "stopping an earlier scan"));
  DTS_TRY(read_calibration(port));
  checks.push_back({.name = "calibration", .outcome = DeviceCheck::Outcome::Passed, .detail = "read from the device, plausible"});
  is_first_scan_ = true;
  if (!settings_.sync_output_bit) return {};
  return prepare_line(port, *settings_.sync_output_bit, model_.line_direction);
}

core::Status FsPlus::read_calibration(usb::UsbPort& port) {
  const std::size_t records = model_.first_record + std::max<std::size_t>(model_.records_per_range, 1) * kFsPlusInputs;
  std::vector<std::uint8_t> memory;
  while (memory.size() < records * kCalibrationRecordBytes) {
    const usb::ControlRequest request{.request = kCalibrationMemory, .value = static_cast<std::uint16_t>(memory.size())};
    const std::size_t piece = std::min(kMemoryPieceBytes, records * kCalibrationRecordBytes - memory.size());
    DTS_TRY_ASSIGN(const auto bytes, get(port, request, piece, "reading the calibration memory"));
    memory.insert(memory.end(), bytes.begin(), bytes.end());
  }
  const usb::DaqOptions& options = settings_.options;
  for (std::size_t position = 0; position < options.channels.size(); ++position) {
    const std::size_t input = options.channels[position];
    const double range_v = options.ranges_v[position];
    const std::size_t record = model_.first_record + model_.records_per_range * model_.range_code(range_v) + input;
    const auto bytes = std::span(memory).subspan(record * kCalibrationRecordBytes, kCalibrationRecordBytes);
    DTS_TRY_ASSIGN(const auto calibration, decode_calibration(bytes, model_.bits, "calibration of ch" + std::to_string(input)));
    lines_[position] = voltage_line(calibration, range_v, model_.bits);
  }
  return {};
}

core::Status FsPlus::make_quiet(usb::UsbPort& port) {
  DTS_TRY(put(port, {.request = kScanStop}, "stopping the scan"));
  DTS_TRY(put(port, {.request = kClearFifo}, "clearing the FIFO"));
  (void)put(port, {.request = kStatus}, "clearing error bits");  // not every public driver sends this: a rejected request is not an error
  return empty_endpoint(port, kDataEndpoint);
}

core::Status FsPlus::set_ranges(usb::UsbPort& port) {
  if (!model_.has_range_list) return {};
  std::vector<std::uint8_t> codes(kFsPlusInputs, model_.range_code(model_.ranges_v.front()));
  const usb::DaqOptions& options = settings_.options;
  for (std::size_t i = 0; i < options.channels.size(); ++i) codes[options.channels[i]] = model_.range_code(options.ranges_v[i]);
  DTS_TRY(put(port, {.request = kRangeList}, codes, "setting the ranges"));
  DTS_TRY_ASSIGN(const auto found, get(port, {.request = kRangeList}, codes.size(), "reading the ranges back"));
  if (found == codes) return {};
  return core::fail(ErrorCode::DataDamaged, description_.uri + " did not accept its ranges", kOtherProgramHint);
}

core::Result<usb::ScanPlan> FsPlus::configure(usb::UsbPort& port, const usb::ScanRequest& request) {
  DTS_TRY_ASSIGN(const auto packet_bytes, port.max_packet_bytes(kDataEndpoint));
  const std::size_t channels = settings_.options.channels.size();
  const StreamLoad load{.scan_hz = request.rate.hz(), .channels = channels, .packet_bytes = packet_bytes};
  const TransferChoice choice = choose_transfers(load, request);
  command_.is_immediate = choice.is_immediate;
  command_.period = pace(model_, channels, request.rate).period;
  command_.trigger = request.is_restart ? Trigger::None : settings_.trigger;
  may_start_late_ = !request.is_restart && (settings_.trigger != Trigger::None || settings_.is_partner_triggered);

  DTS_TRY(make_quiet(port));
  DTS_TRY(set_ranges(port));
  const bool is_first = std::exchange(is_first_scan_, false);
  if (is_first && model_.often_fails_first_start) {
    DTS_TRY(start_in_vain(port));
  }
  return plan_of(choice, kDataEndpoint);
}

core::Status FsPlus::start_in_vain(usb::UsbPort& port) {
  DTS_TRY(send_start(port));
  DTS_TRY(health(port));
  return make_quiet(port);
}

core::Result<std::vector<double>> FsPlus::read_once(usb::UsbPort& port) {
  const usb::DaqOptions& options = settings_.options;
  std::vector<double> readings;
  for (std::size_t position = 0; position < options.channels.size(); ++position) {
    const usb::ControlRequest request{.request = kReadInput,
                                      .value = static_cast<std::uint16_t>(options.channels[position]),
                                      .index = model_.range_code(options.ranges_v[position])};
    DTS_TRY_ASSIGN(const auto code, get_word(port, request, "reading ch" + std::to_string(options.channels[position])));
    readings.push_back(volts(position, code));
  }
  return readings;
}

core::Status FsPlus::send_start(usb::UsbPort& port) {
  return put(port, {.request = kScanStart}, encode_start(model_.start, command_), "starting the scan");
}

core::Status FsPlus::make_ready(usb::UsbPort& port) {
  DTS_TRY(put(port, {.request = kClearFifo}, "clearing the FIFO"));
  return empty_endpoint(port, kDataEndpoint);
}

core::Status FsPlus::begin(usb::UsbPort& port) { return send_start(port); }

core::Status FsPlus::end(usb::UsbPort& port) noexcept {
  DTS_TRY(put(port, {.request = kScanStop}, "stopping the scan", usb::kControlTimeoutMs));
  return await_end(*this, port);
}

core::Result<usb::ScanHealth> FsPlus::health(usb::UsbPort& port) {
  return get_word(port, {.request = kStatus}, "reading the status", usb::kControlTimeoutMs).map([](std::uint16_t status) {
    return usb::ScanHealth{.is_running = (status & kScanRunning) != 0, .is_overrun = (status & kScanOverrun) != 0};
  });
}

bool FsPlus::waits_for_trigger() const noexcept { return command_.trigger != Trigger::None || settings_.sync == SyncPin::Input; }

core::Status FsPlus::set_sync_output(usb::UsbPort& port, bool is_high) {
  if (settings_.sync_output_bit) return drive_line(port, *settings_.sync_output_bit, is_high);
  return core::fail(ErrorCode::Unsupported, description_.uri + " has no digital line chosen for the sync pulse",
                    "add sync_output_bit=0 to the device address and wire digital line 0");
}

usb::Unpacked FsPlus::unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept {
  const CodesRead read = read_codes(bytes, codes, model_.largest_code());
  return {.bytes = read.bytes, .codes = read.codes, .fault = read.is_damaged ? core::GapReason::Integrity : core::GapReason::None};
}

}  // namespace dts::device::mcc
