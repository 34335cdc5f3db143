// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/usb1608g_emulator.h"

#include <algorithm>

#include "usb/emulator/mcc_bytes.h"
#include "usb/emulator/mcc_descriptors.h"

namespace dts::emulator {
namespace {

constexpr std::uint8_t kGEndpoint = 0x86;
constexpr std::int64_t kClockHz = 64'000'000;
constexpr std::size_t kGMemoryBytes = 0x8000;
constexpr std::size_t kCalibrationAt = 0x7000;
constexpr std::size_t kLargestPiece = 64;
constexpr std::array kRangesV = {10.0, 5.0, 2.0, 1.0};
constexpr unsigned kLastElement = 0x80;

std::string name_of(std::uint16_t product) {
  switch (product) {
    case 0x0110:
    case 0x0134: return "USB-1608G";
    case 0x0111:
    case 0x0135: return "USB-1608GX";
    default: return "USB-1608GX-2AO";
  }
}

}  // namespace

Usb1608gEmulator::Usb1608gEmulator(std::uint16_t product, const std::string& serial, Source source, bool is_high_speed)
    : product_(product),
      serial_(serial),
      descriptors_(mcc_descriptors({.product = product,
                                    .name = name_of(product),
                                    .serial = serial,
                                    .is_high_speed = is_high_speed,
                                    .in_endpoint = kGEndpoint,
                                    .out_endpoint = 0x02})),
      memory_(kGMemoryBytes, 0xFF),
      scan_(std::move(source), kInputs) {
  for (std::size_t range = 0; range < kRangesV.size(); ++range) {
    const auto [slope, offset] = calibration(range);
    put_float(memory_, kCalibrationAt + 8 * range, slope);
    put_float(memory_, kCalibrationAt + 8 * range + 4, offset);
  }
}

std::pair<float, float> Usb1608gEmulator::calibration(std::size_t range_code) {
  const auto number = static_cast<float>(range_code);
  return {1.0121F + 0.0013F * number, -390.0F + 21.5F * number};
}

void Usb1608gEmulator::power_up(std::int64_t now_ns) {
  stop(now_ns);
  scan_.power_up();
  list_.fill(0);
  trigger_config_ = 0;
  tristate_ = 0xFF;
  latch_ = 0;
  is_configured_ = false;
  is_configuring_ = false;
  power_up_ns_ = now_ns;
}

void Usb1608gEmulator::suspend(std::int64_t now_ns) {
  stop(now_ns);
  scan_.clear_fifo();
  is_configured_ = false;
}

ControlReply Usb1608gEmulator::control(const Setup& setup, std::span<const std::uint8_t> out_data, std::int64_t now_ns) {
  if (faults.is_mute) return silent();
  if (faults.silent_control_requests > 0) {
    --faults.silent_control_requests;
    return silent();
  }
  if (setup.request_type == 0xC0) return read_request(setup, now_ns);
  if (setup.request_type == 0x40) return write_request(setup, out_data, now_ns);
  return refused();
}

ControlReply Usb1608gEmulator::read_request(const Setup& setup, std::int64_t now_ns) {
  switch (setup.request) {
    case 0x00: return done({tristate_});
    case 0x01: return done({static_cast<std::uint8_t>(latch_ & ~tristate_)});
    case 0x02: return done({latch_});
    case 0x10: return read_input(setup.value, now_ns);
    case 0x14: return scan_.is_running() ? refused() : done({list_.begin(), list_.end()});
    case 0x30: return read_memory(setup.length);
    case 0x31: return done_u16(address_);
    case 0x40:
      return done_u16((scan_.is_running() || armed_ ? 1U << 1 : 0U) | (scan_.is_overrun() ? 1U << 2 : 0U) |
                      (is_configured_ ? 1U << 8 : 0U) | (is_configuring_ ? 1U << 9 : 0U));
    case 0x43: return done({trigger_config_});
    case 0x45: return done_u16(30U << 8U);
    case 0x48: return done({serial_.begin(), serial_.end()});
    case 0x52: return done_u16(0x0105);
    default: return refused();
  }
}

ControlReply Usb1608gEmulator::write_request(const Setup& setup, std::span<const std::uint8_t> data, std::int64_t now_ns) {
  switch (setup.request) {
    case 0x00: tristate_ = static_cast<std::uint8_t>(setup.value); return done();
    case 0x02: latch_ = static_cast<std::uint8_t>(setup.value); return done();
    case 0x12: return start_request(data, now_ns);
    case 0x13: stop(now_ns); return done();
    case 0x14: return set_list(data);
    case 0x15: scan_.clear_fifo(); return done();
    case 0x31:
      if (data.size() != 2) return refused();
      address_ = static_cast<std::uint16_t>(data[0] | data[1] << 8U);
      return done();
    case 0x41: return done();
    case 0x42: wants_to_leave_ = true; return done();
    case 0x43:
      if (data.size() != 1) return refused();
      trigger_config_ = data[0];
      return done();
    case 0x50: return fpga_command(data);
    case 0x51: return fpga_data(data.size());
    case 0x30:
    case 0x44:
    case 0x48: ++forbidden_requests; return refused();
    default: return refused();
  }
}

ControlReply Usb1608gEmulator::read_memory(std::size_t length) {
  if (length > kLargestPiece) return refused();
  std::size_t size = kGMemoryBytes;
  if (faults.calibration_bytes < kGMemoryBytes) size = kCalibrationAt + faults.calibration_bytes;
  const std::size_t begin = std::min<std::size_t>(address_, size);
  const std::size_t count = std::min(length, size - begin);
  address_ = static_cast<std::uint16_t>(begin + count);
  if (faults.is_calibration_garbage) return done(std::vector<std::uint8_t>(count, 0xFF));
  const auto first = memory_.begin() + static_cast<std::ptrdiff_t>(begin);
  return done({first, first + static_cast<std::ptrdiff_t>(count)});
}

ControlReply Usb1608gEmulator::fpga_command(std::span<const std::uint8_t> data) {
  if (data.size() != 1 || data[0] != 0xAD) return refused();
  is_configured_ = false;
  is_configuring_ = true;
  image_received_ = 0;
  return done();
}

ControlReply Usb1608gEmulator::fpga_data(std::size_t count) {
  if (!is_configuring_ || count > kLargestPiece) return refused();
  image_received_ += count;
  if (image_received_ != image_bytes(product_)) return done();
  is_configuring_ = false;
  is_configured_ = true;
  is_next_reading_garbage_ = true;
  ++images_loaded_;
  return done();
}

ControlReply Usb1608gEmulator::set_list(std::span<const std::uint8_t> data) {
  if (scan_.is_running() || data.size() != list_.size()) return refused();
  if (!ignores_scan_list) std::copy(data.begin(), data.end(), list_.begin());
  return done();
}

std::vector<Usb1608gEmulator::Element> Usb1608gEmulator::list() const {
  std::vector<Element> elements;
  for (const unsigned byte : list_) {
    const unsigned mode = byte >> 5U & 3U;  // 1: single-ended 0 to 7, 2: single-ended 8 to 15
    elements.push_back({.input = (byte & 7U) + (mode == 2 ? 8U : 0U), .range_code = byte >> 3U & 3U});
    if ((byte & kLastElement) != 0) break;
  }
  return elements;
}

ControlReply Usb1608gEmulator::read_input(std::size_t input, std::int64_t now_ns) {
  if (scan_.is_running() || !is_configured_ || input >= kInputs) return refused();
  if (std::exchange(is_next_reading_garbage_, false)) return done_u16(0xDEAD);
  const std::size_t range_code = list().front().range_code;
  const auto [slope, offset] = calibration(range_code);
  const double time_s = static_cast<double>(now_ns - power_up_ns_) * 1e-9;
  const std::uint16_t code = to_code(scan_.feed().look(time_s)[input], kRangesV[range_code], 16, slope, offset);
  if (leaves_readings_in_fifo) scan_.leave(code);
  return done_u16(code);
}

ControlReply Usb1608gEmulator::start_request(std::span<const std::uint8_t> data, std::int64_t now_ns) {
  const bool is_length_right = data.size() == 15 || (data.size() == 14 && !takes_only_15_bytes);
  if (!is_length_right || !is_configured_ || scan_.is_running() || armed_) return refused();
  last_start_.assign(data.begin(), data.end());
  const Start start{.scans = u32_at(data, 0),
                    .period = u32_at(data, 8),
                    .packet_codes = data[12] + std::size_t{1},
                    .is_burst = (data[13] & 1U) != 0,
                    .has_trigger = (data[13] & 8U) != 0};
  scan_.clear_errors();
  if (start.has_trigger) {
    armed_ = start;
  } else {
    run(start, now_ns);
  }
  return done();
}

void Usb1608gEmulator::fire_trigger(std::int64_t now_ns) {
  if (armed_) run(*std::exchange(armed_, std::nullopt), now_ns);
}

void Usb1608gEmulator::run(const Start& start, std::int64_t now_ns) {
  const std::vector<Element> elements = list();
  FeedSetup setup;
  for (const Element& element : elements) setup.inputs.push_back(element.input);
  const bool is_paced_by_scan = start.is_burst || !non_burst_divides_rate;
  setup.codes_per_tick = is_paced_by_scan ? elements.size() : 1;
  setup.skew_s = is_paced_by_scan ? kSkewS : 0.0;
  setup.fifo_codes = kFifoCodes;
  setup.last_code = std::uint64_t{start.scans} * elements.size();
  if (start.period != 0) setup.rate = core::Rate::create(kClockHz, std::int64_t{start.period} + 1).value();
  if (rotated_starts > 0) {
    --rotated_starts;
    faults.drop_code_at = 0;
  }
  const MccPacking packing{.codes_per_packet = start.packet_codes, .endpoint_bytes = descriptors_.is_high_speed ? 512U : 64U};
  Converter converter = [elements](std::size_t position, double volts) {
    const auto [slope, offset] = calibration(elements[position].range_code);
    return to_code(volts, kRangesV[elements[position].range_code], 16, slope, offset);
  };
  scan_.start(std::move(setup), std::move(converter), packing, faults, start.period == 0 ? &unconnected_ : nullptr, now_ns);
}

void Usb1608gEmulator::stop(std::int64_t now_ns) {
  armed_.reset();
  scan_.stop(now_ns);
}

std::optional<Packet> Usb1608gEmulator::take_packet(std::uint8_t endpoint, std::int64_t now_ns) {
  if (endpoint != kGEndpoint || faults.is_mute) return std::nullopt;
  return scan_.take_packet(now_ns);
}

void Usb1608gEmulator::clear_halt(std::uint8_t endpoint) {
  if (endpoint == kGEndpoint) scan_.clear_halt();
}

}  // namespace dts::emulator
