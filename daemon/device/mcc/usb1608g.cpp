// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/usb1608g.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "device/device_checks.h"
#include "device/mcc/control.h"
#include "device/mcc/description.h"

namespace dts::device::mcc {
namespace {

using core::ErrorCode;

constexpr std::uint8_t kGDataEndpoint = 0x86;
constexpr std::int64_t kClockHz = 64'000'000;
constexpr unsigned kBits = 16;

// Vendor requests (uldaq: src/usb/ai/AiUsb1608g.h; Linux_Drivers: usb-1608G.c). Start, stop and status differ from the FS-Plus.
constexpr std::uint8_t kGReadInput = 0x10;
constexpr std::uint8_t kGScanStart = 0x12;
constexpr std::uint8_t kGScanStop = 0x13;
constexpr std::uint8_t kScanList = 0x14;
constexpr std::uint8_t kGClearFifo = 0x15;
constexpr std::uint8_t kMemory = 0x30;
constexpr std::uint8_t kMemoryAddress = 0x31;
constexpr std::uint8_t kTriggerConfig = 0x43;

constexpr std::uint16_t kCalibrationAddress = 0x7000;
constexpr std::size_t kRanges = 4;
constexpr std::uint16_t kHighestCode = 0xFFFC;  // Linux_Drivers treats codes beyond these as saturated
constexpr std::uint16_t kLowestCode = 0x0061;

constexpr std::size_t kShortStartBytes = 14;
constexpr unsigned kBurst = 1U << 0;
constexpr unsigned kUseTrigger = 1U << 3;

/// Returns the code of a range: its position in the list.
std::size_t range_code(double range_v) {
  constexpr std::array kByCode = {10.0, 5.0, 2.0, 1.0};
  const auto found = std::find(kByCode.begin(), kByCode.end(), range_v);
  return found == kByCode.end() ? 0 : static_cast<std::size_t>(found - kByCode.begin());
}

/// Returns the trigger byte: bit 0 edge, bit 1 rising or high.
std::uint8_t trigger_byte(Trigger trigger) {
  switch (trigger) {
    case Trigger::Rising: return 3;
    case Trigger::Falling: return 1;
    case Trigger::High: return 2;
    case Trigger::None:
    case Trigger::Low: break;
  }
  return 0;
}

}  // namespace

Usb1608g::Usb1608g(const Usb1608gModel& model, Usb1608gSettings settings)
    : model_(model),
      settings_(std::move(settings)),
      description_(describe_unit(model.revisions.front().name, settings_.options, kBits,
                                 model.max_aggregate_hz / static_cast<double>(settings_.options.channels.size()))) {
  for (const double range_v : settings_.options.ranges_v) lines_.push_back(voltage_line({}, range_v, kBits));
  description_.has_sync_output = settings_.sync_output_bit.has_value();
  command_.has_trigger = settings_.trigger != Trigger::None;
}

core::Result<core::Rate> Usb1608g::exact_rate(core::Rate wanted) const {
  const auto checked = check_rate(description_, wanted);
  if (!checked) return checked;
  return pace(kClockHz, 1, wanted).rate;
}

bool Usb1608g::is_rail(std::size_t, std::uint16_t code) const noexcept { return code < kLowestCode || code > kHighestCode; }

core::Status Usb1608g::connect(usb::UsbPort& port, std::vector<DeviceCheck>& checks) {
  DTS_TRY_ASSIGN(const auto loaded, ensure_fpga(port));
  checks.push_back({.name = "FPGA image", .outcome = DeviceCheck::Outcome::Passed, .detail = loaded ? "loaded" : "was there already"});
  DTS_TRY(put(port, {.request = kGScanStop}, "stopping an earlier scan"));
  DTS_TRY(read_calibration(port));
  checks.push_back({.name = "calibration", .outcome = DeviceCheck::Outcome::Passed, .detail = "read from the device, plausible"});
  if (!settings_.sync_output_bit) return {};
  return prepare_line(port, *settings_.sync_output_bit, LineDirection::PerLine);
}

/// Loads the FPGA image if the device has none; returns true if it was loaded.
core::Result<bool> Usb1608g::ensure_fpga(usb::UsbPort& port) {
  DTS_TRY_ASSIGN(const auto status, read_g_status(port));
  if (status.is_fpga_loaded) return false;
  DTS_TRY_ASSIGN(const auto image, read_fpga_image(settings_.fpga_path, port.unit().product));
  DTS_TRY(load_fpga(port, image));
  // The first conversion after loading is garbage (uldaq: AiUsb1608g::initialize).
  DTS_TRY(convert(port, settings_.options.channels.front(), settings_.options.ranges_v.front()));
  return true;
}

core::Status Usb1608g::read_calibration(usb::UsbPort& port) {
  const std::array<std::uint8_t, 2> address = {kCalibrationAddress & 0xFFU, kCalibrationAddress >> 8U};
  DTS_TRY(put(port, {.request = kMemoryAddress}, address, "addressing the calibration memory"));
  DTS_TRY_ASSIGN(const auto memory, get(port, {.request = kMemory}, kRanges * kCalibrationRecordBytes, "reading the calibration memory"));
  const usb::DaqOptions& options = settings_.options;
  for (std::size_t position = 0; position < lines_.size(); ++position) {
    const double range_v = options.ranges_v[position];
    const auto record = std::span(memory).subspan(range_code(range_v) * kCalibrationRecordBytes, kCalibrationRecordBytes);
    DTS_TRY_ASSIGN(const auto calibration,
                   decode_calibration(record, kBits, "calibration of ch" + std::to_string(options.channels[position])));
    lines_[position] = voltage_line(calibration, range_v, kBits);
  }
  return {};
}

core::Status Usb1608g::make_quiet(usb::UsbPort& port) {
  DTS_TRY(put(port, {.request = kGScanStop}, "stopping the scan"));
  DTS_TRY(put(port, {.request = kGClearFifo}, "clearing the FIFO"));
  return empty_endpoint(port, kGDataEndpoint);
}

core::Status Usb1608g::set_trigger(usb::UsbPort& port) {
  if (!command_.has_trigger) return {};
  const std::array<std::uint8_t, 1> config = {trigger_byte(settings_.trigger)};
  return put(port, {.request = kTriggerConfig}, config, "setting the trigger");
}

core::Status Usb1608g::set_scan_list(usb::UsbPort& port) {
  const auto list = encode_scan_list(settings_.options.channels, settings_.options.ranges_v);
  DTS_TRY(put(port, {.request = kScanList}, list, "setting the scan list"));
  DTS_TRY_ASSIGN(const auto found, get(port, {.request = kScanList}, list.size(), "reading the scan list back"));
  if (std::equal(found.begin(), found.end(), list.begin(), list.end())) return {};
  return core::fail(ErrorCode::DataDamaged, description_.uri + " did not accept its scan list",
                    "close any other program that uses the device");
}

core::Result<usb::ScanPlan> Usb1608g::configure(usb::UsbPort& port, const usb::ScanRequest& request) {
  DTS_TRY_ASSIGN(const auto packet_bytes, port.max_packet_bytes(kGDataEndpoint));
  const StreamLoad load{.scan_hz = request.rate.hz(), .channels = lines_.size(), .packet_bytes = packet_bytes};
  const GPackets packets = choose_g_packets(load, request);
  command_.packet_codes = packets.packet_codes;
  command_.period = pace(kClockHz, 1, request.rate).period;
  command_.has_trigger = settings_.trigger != Trigger::None && !request.is_restart;

  // After a suspend of the host the FPGA may have lost its image, although the unit stayed on the bus.
  DTS_TRY(ensure_fpga(port));
  DTS_TRY(make_quiet(port));
  DTS_TRY(set_trigger(port));
  DTS_TRY(set_scan_list(port));
  return plan_of(packets.transfers, kGDataEndpoint);
}

core::Result<std::uint16_t> Usb1608g::convert(usb::UsbPort& port, std::size_t input, double range_v) {
  const auto list = encode_scan_list({&input, 1}, {&range_v, 1});
  DTS_TRY(put(port, {.request = kScanList}, list, "setting a scan list of one input"));
  return get_word(port, {.request = kGReadInput, .value = static_cast<std::uint16_t>(input)}, "reading ch" + std::to_string(input));
}

core::Result<std::vector<double>> Usb1608g::read_once(usb::UsbPort& port) {
  const usb::DaqOptions& options = settings_.options;
  std::vector<double> readings;
  for (std::size_t position = 0; position < options.channels.size(); ++position) {
    DTS_TRY_ASSIGN(const auto code, convert(port, options.channels[position], options.ranges_v[position]));
    readings.push_back(volts(position, code));
  }
  DTS_TRY(set_scan_list(port));
  return readings;
}

core::Status Usb1608g::make_ready(usb::UsbPort& port) {
  DTS_TRY(put(port, {.request = kGClearFifo}, "clearing the FIFO"));
  return empty_endpoint(port, kGDataEndpoint);
}

core::Status Usb1608g::begin(usb::UsbPort& port) {
  std::vector<std::uint8_t> bytes = encode_g_start(command_);
  const usb::UsbResult sent = port.control_out({.request = kGScanStart}, bytes, usb::kSetupTimeoutMs);
  if (sent || sent.error() != usb::UsbStatus::Stall) {
    if (sent && *sent == bytes.size()) return {};
    return tl::make_unexpected(usb::to_error(sent ? usb::UsbStatus::Failed : sent.error(), "starting the scan"));
  }
  bytes.push_back(0);  // uldaq appends a reserved byte: some firmware may need it
  return put(port, {.request = kGScanStart}, bytes, "starting the scan");
}

core::Status Usb1608g::end(usb::UsbPort& port) noexcept {
  DTS_TRY(put(port, {.request = kGScanStop}, "stopping the scan", usb::kControlTimeoutMs));
  return await_end(*this, port);
}

core::Result<usb::ScanHealth> Usb1608g::health(usb::UsbPort& port) {
  return read_g_status(port, usb::kControlTimeoutMs).map([](const GStatus& status) {
    return usb::ScanHealth{.is_running = status.is_running && status.is_fpga_loaded, .is_overrun = status.is_overrun};
  });
}

core::Status Usb1608g::set_sync_output(usb::UsbPort& port, bool is_high) {
  if (settings_.sync_output_bit) return drive_line(port, *settings_.sync_output_bit, is_high);
  return core::fail(ErrorCode::Unsupported, description_.uri + " has no digital line chosen for the sync pulse",
                    "add sync_output_bit=0 to the device address and wire digital line 0");
}

usb::Unpacked Usb1608g::unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept {
  const CodesRead read = read_codes(bytes, codes, std::numeric_limits<std::uint16_t>::max());
  return {.bytes = read.bytes, .codes = read.codes, .fault = read.is_damaged ? core::GapReason::Integrity : core::GapReason::None};
}

std::array<std::uint8_t, kScanListBytes> encode_scan_list(std::span<const std::size_t> inputs, std::span<const double> ranges_v) {
  std::array<std::uint8_t, kScanListBytes> list{};
  const std::size_t count = std::min(inputs.size(), list.size());
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned mode = inputs[i] < 8 ? 1U : 2U;
    const unsigned last = i + 1 == count ? 0x80U : 0U;
    list[i] = static_cast<std::uint8_t>((inputs[i] & 7U) | range_code(ranges_v[i]) << 3U | mode << 5U | last);
  }
  return list;
}

std::vector<std::uint8_t> encode_g_start(const GStartCommand& command) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(kShortStartBytes + 1);
  append_u32(bytes, 0);  // number of scans: endless
  append_u32(bytes, 0);  // no retrigger
  append_u32(bytes, command.period);
  bytes.push_back(static_cast<std::uint8_t>(command.packet_codes - 1));
  bytes.push_back(static_cast<std::uint8_t>(kBurst | (command.has_trigger ? kUseTrigger : 0U)));
  return bytes;
}

}  // namespace dts::device::mcc
