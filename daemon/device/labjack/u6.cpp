// SPDX-License-Identifier: Apache-2.0
#include "device/labjack/u6.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include "device/device_checks.h"
#include "device/labjack/u6_frames.h"
#include "device/labjack/u6_timing.h"

namespace dts::device::labjack {
namespace {

using core::ErrorCode;
using Outcome = DeviceCheck::Outcome;

constexpr std::array kModels = {usb::UsbModel{0x0CD5, 0x0006, "LabJack U6", "labjack:u6"}};
constexpr std::size_t kGround = 15;
constexpr double kLastCode = 65'535.0;
constexpr std::uint16_t kRailCodes = 1;  // the end code and the code next to it
constexpr int kDrainTimeoutMs = 20;
constexpr int kMostDrainReads = 64;  // more than the FIFO holds; ends the loop if the device never falls silent
constexpr std::size_t kDrainBytes = 16 * kUsbPacketBytes;
constexpr std::int64_t kInFlightNs =
    500'000'000;  // as in the MCC drivers: the host may be blocked for this long; the FIFO alone lasts 20 ms at full speed
constexpr std::int64_t kBufferedNs = 2'000'000'000;

std::size_t gain_of(double range_v) noexcept { return static_cast<std::size_t>(std::ranges::find(kRangesV, range_v) - kRangesV.begin()); }

ChannelDescription describe_channel(std::size_t input, std::size_t gain) {
  if (input == kDigitalWord) return {"digital", "", ChannelRole::Auxiliary, 0.0, kLastCode, 1.0};
  const Calibration::Gain nominal = Calibration::nominal().gain(gain);
  const ChannelRole role = input == kGround ? ChannelRole::Auxiliary : ChannelRole::Sensor;
  return {"ch" + std::to_string(input),
          "V",
          role,
          nominal.center * nominal.negative_slope_v,
          (kLastCode - nominal.center) * nominal.positive_slope_v,
          nominal.positive_slope_v};
}

/// Discards old data in the stream endpoint while no scan is running.
core::Status drain(usb::UsbPort& port) {
  std::vector<std::uint8_t> buffer(kDrainBytes);
  for (int i = 0; i < kMostDrainReads; ++i) {
    const auto received = port.bulk_in(kStreamEndpoint, buffer, kDrainTimeoutMs);
    if (received) continue;
    if (received.error() == usb::UsbStatus::TimedOut) return {};
    if (received.error() != usb::UsbStatus::Stall) return tl::make_unexpected(usb::to_error(received.error(), "LabJack U6: stream data"));
    if (const auto cleared = port.clear_halt(kStreamEndpoint); !cleared) {
      return tl::make_unexpected(usb::to_error(cleared.error(), "LabJack U6: stream data"));
    }
  }
  return core::fail(ErrorCode::Failed, "LabJack U6: the unit does not stop sending stream data", "unplug it and plug it in again");
}

std::size_t transfers_for(std::int64_t time_ns, std::int64_t period_ns, std::size_t least, std::size_t most) noexcept {
  return std::clamp(static_cast<std::size_t>(time_ns / std::max<std::int64_t>(period_ns, 1)), least, most);
}

std::string describe_packing(const Packing& packing, std::size_t channels) {
  const std::string samples = std::to_string(packing.samples_per_packet);
  if (packing.samples_per_packet % channels == 0 && packing.packets_per_transfer == 1) {
    const std::size_t scans = packing.samples_per_packet / channels;
    return "immediate, " + (scans == 1 ? "one scan" : std::to_string(scans) + " scans") + " per packet";
  }
  return std::to_string(packing.packets_per_transfer) + " packets of " + samples + " samples per transfer";
}

}  // namespace

std::vector<usb::UsbModel> u6_models() { return {kModels.begin(), kModels.end()}; }

U6::U6(usb::DaqOptions options) : options_(std::move(options)) {
  description_.uri = options_.uri;
  description_.model = "LabJack U6";
  description_.serial = options_.serial;
  description_.minimum_rate_hz = kMinimumRateHz;
  description_.maximum_rate_hz = kMaximumSamplesPerSecond / static_cast<double>(options_.channels.size());
  for (std::size_t i = 0; i < options_.channels.size(); ++i) {
    gains_.push_back(options_.channels[i] == kDigitalWord ? kRangesV.size() : gain_of(options_.ranges_v[i]));
    description_.channels.push_back(describe_channel(options_.channels[i], gains_.back()));
  }
  if (options_.marker) description_.channels[options_.marker->position].role = ChannelRole::Marker;
}

std::span<const usb::UsbModel> U6::models() const noexcept { return kModels; }

core::Result<core::Rate> U6::exact_rate(core::Rate wanted) const {
  DTS_TRY(check_rate(description_, wanted));
  return nearest_clock(wanted).rate;
}

double U6::volts(std::size_t channel, std::uint16_t code) const noexcept {
  return gains_[channel] < kRangesV.size() ? calibration_.volts(gains_[channel], code) : static_cast<double>(code);
}

bool U6::is_rail(std::size_t channel, std::uint16_t code) const noexcept {
  return gains_[channel] < kRangesV.size() && (code <= kRailCodes || code >= 0xFFFF - kRailCodes);
}

core::Status U6::connect(usb::UsbPort& port, std::vector<DeviceCheck>& checks) {
  DTS_TRY(end_earlier_stream(port, checks));
  DTS_TRY(identify(port, checks));
  DTS_TRY(read_constants(port, checks));
  // Timers and counters use pins of the digital word.
  DTS_TRY(run(port, turn_timers_off()));
  return {};
}

core::Status U6::end_earlier_stream(usb::UsbPort& port, std::vector<DeviceCheck>& checks) {
  DTS_TRY_ASSIGN(const auto stopped, exchange(port, stop_stream()));
  if (stopped.error != 0 && stopped.error != kErrorStreamNotRunning) return tl::make_unexpected(refused("StreamStop", stopped.error));
  if (stopped.error == 0)
    checks.push_back({"no scan was running", Outcome::Warning, "a scan of an earlier program was running; dtsd stopped it"});
  return {};  // `configure` discards its data in the stream endpoint
}

core::Status U6::identify(usb::UsbPort& port, std::vector<DeviceCheck>& checks) {
  DTS_TRY_ASSIGN(const auto reply, run(port, read_unit()));
  const std::vector<std::uint8_t>& bytes = reply.bytes;
  std::uint32_t serial = 0;
  for (std::size_t i = 4; i-- > 0;) serial = serial << 8U | bytes[15 + i];
  const std::string minor = std::to_string(bytes[9]);
  identity_.serial = std::to_string(serial);
  identity_.firmware = std::to_string(bytes[10]) + "." + (minor.size() < 2 ? "0" : "") + minor;
  const bool is_pro = bytes[37] == 12;
  checks.push_back({"the unit is a U6", is_pro || bytes[37] == 4 ? Outcome::Passed : Outcome::Warning,
                    std::string(is_pro ? "U6-Pro" : "U6") + ", version code " + std::to_string(bytes[37])});
  return {};
}

core::Status U6::read_constants(usb::UsbPort& port, std::vector<DeviceCheck>& checks) {
  std::vector<std::uint8_t> blocks;
  for (std::uint8_t block = 0; block < kCalibrationBlocks; ++block) {
    DTS_TRY_ASSIGN(const auto reply, run(port, read_calibration(block)));
    blocks.insert(blocks.end(), reply.bytes.end() - kCalibrationBlockBytes, reply.bytes.end());
  }
  std::vector<std::size_t> in_use;
  std::ranges::copy_if(gains_, std::back_inserter(in_use), [](std::size_t gain) { return gain < kRangesV.size(); });
  DTS_TRY_ASSIGN(calibration_, Calibration::parse(blocks, in_use));
  checks.push_back({"the calibration is plausible", Outcome::Passed, "read from the unit"});
  return {};
}

core::Result<usb::ScanPlan> U6::configure(usb::UsbPort& port, const usb::ScanRequest& request) {
  // The last StreamStop may have been lost, and firmware before 0.94 leaves data in the endpoint (Exodriver's u6Stream example).
  DTS_TRY(exchange(port, stop_stream()));
  DTS_TRY(drain(port));
  const std::size_t channels = options_.channels.size();
  const ScanClock clock = nearest_clock(request.rate);
  const Packing packing = pack(clock.rate, channels, request.latency_ns, request.must_use_large_packets);
  StreamSetup setup{.samples_per_packet = static_cast<std::uint8_t>(packing.samples_per_packet),
                    .scan_config = clock.scan_config,
                    .interval = clock.interval,
                    .channels = {},
                    .options = {}};
  for (std::size_t i = 0; i < channels; ++i) {
    setup.channels.push_back(static_cast<std::uint8_t>(options_.channels[i]));
    setup.options.push_back(gains_[i] < kRangesV.size() ? static_cast<std::uint8_t>(gains_[i] << 4U) : std::uint8_t{0});
  }
  DTS_TRY(run(port, configure_stream(setup)));
  parser_.restart(channels, packing.samples_per_packet);

  usb::ScanPlan plan;
  plan.shape.endpoint = kStreamEndpoint;
  plan.shape.transfer_bytes = packing.packets_per_transfer * kUsbPacketBytes;
  plan.shape.transfer_count = transfers_for(kInFlightNs, packing.transfer_period_ns, 8, 1024);
  plan.shape.buffer_chunks = transfers_for(kBufferedNs, packing.transfer_period_ns, 64, 4096);
  plan.packet_period_ns = packing.transfer_period_ns;
  plan.sentence = describe_packing(packing, channels);
  return plan;
}

core::Result<std::vector<double>> U6::read_once(usb::UsbPort&) {
  return core::fail(ErrorCode::Unsupported, "LabJack U6: single readings are not implemented",
                    "use the ground channel: marker=15&marker_v=0");
}

core::Status U6::begin(usb::UsbPort& port) {
  DTS_TRY(run(port, start_stream()));
  return {};
}

core::Status U6::end(usb::UsbPort& port) noexcept {
  DTS_TRY_ASSIGN(const auto stopped, exchange(port, stop_stream(), usb::kControlTimeoutMs));
  if (stopped.error == 0 || stopped.error == kErrorStreamNotRunning) return {};
  return tl::make_unexpected(refused("StreamStop", stopped.error));
}

core::Result<usb::ScanHealth> U6::health(usb::UsbPort& port) {
  // Only this command and StreamStop are allowed during a stream. Its reply does not show whether a stream is running.
  DTS_TRY(run(port, read_unit(), usb::kControlTimeoutMs));
  return usb::ScanHealth{.is_running = true, .is_overrun = parser_.is_recovering()};
}

}  // namespace dts::device::labjack
