// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/fs_plus_emulator.h"

#include <algorithm>
#include <cmath>

#include "usb/emulator/mcc_bytes.h"
#include "usb/emulator/mcc_descriptors.h"

namespace dts::emulator {
namespace {

constexpr std::uint8_t kEndpoint = 0x81;
constexpr std::size_t kPacketBytes = 64;
constexpr std::size_t kMemoryBytes = 768;
constexpr double kLoopHighV = 5.0;

constexpr std::array kParts = {
    FsPlusParts{FsPlusKind::Usb1608, 0x00EA, "USB-1608FS-Plus", 16, 40'000'000, true, 32'768, 10, true, 0, true},
    FsPlusParts{FsPlusKind::Usb1208, 0x00E8, "USB-1208FS-Plus", 12, 60'000'000, false, 8'192, 14, true, 32, false, true},
    FsPlusParts{FsPlusKind::Usb1408, 0x00E9, "USB-1408FS-Plus", 14, 60'000'000, false, 8'192, 14, true, 32, false, true},
    FsPlusParts{FsPlusKind::Usb201, 0x0113, "USB-201", 12, 70'000'000, false, 6'144, 12, false, 0, false},
    FsPlusParts{FsPlusKind::Usb202, 0x012B, "USB-202", 12, 70'000'000, false, 6'144, 12, false, 0, false},
    FsPlusParts{FsPlusKind::Usb204, 0x0114, "USB-204", 12, 70'000'000, false, 6'144, 12, false, 0, false},
    FsPlusParts{FsPlusKind::Usb205, 0x012C, "USB-205", 12, 70'000'000, false, 6'144, 12, false, 0, false},
};

const FsPlusParts& parts_of(FsPlusKind kind) {
  return *std::find_if(kParts.begin(), kParts.end(), [kind](const FsPlusParts& parts) { return parts.kind == kind; });
}

double range_of(std::uint8_t code) {
  switch (code) {
    case 1: return 5.0;
    case 3: return 2.0;
    case 5: return 1.0;
    default: return 10.0;
  }
}

}  // namespace

FsPlusEmulator::FsPlusEmulator(FsPlusKind kind, const std::string& serial, Source source)
    : parts_(parts_of(kind)),
      serial_(serial),
      descriptors_(mcc_descriptors({.product = parts_.product, .name = parts_.name, .serial = serial})),
      memory_(kMemoryBytes, 0xFF),
      scan_(
          [this, source = std::move(source)](double time_s, std::span<double> volts) {
            source(time_s, volts);
            mix_loop_back(time_s, volts);
          },
          kInputs) {
  write_calibration();
}

std::pair<float, float> FsPlusEmulator::calibration(std::uint8_t range_code, std::size_t input) const {
  // A few tenths of a percent and a few millivolts, different everywhere: a mixed-up record shows.
  const auto unit = static_cast<float>(1U << parts_.bits) / 65'536.0F;
  const auto number = static_cast<float>(input);
  const auto gain = static_cast<float>(parts_.has_records_per_range ? range_code : 0);
  return {1.0F + 0.0007F * number - 0.0011F * gain, (-40.0F + 9.0F * number + 5.0F * gain) * unit};
}

void FsPlusEmulator::write_calibration() {
  const std::size_t ranges = parts_.has_records_per_range ? 8 : 1;
  for (std::size_t range = 0; range < ranges; ++range) {
    for (std::size_t input = 0; input < kInputs; ++input) {
      const auto [slope, offset] = calibration(static_cast<std::uint8_t>(range), input);
      const std::size_t at = 8 * (parts_.single_ended_record + kInputs * range + input);
      put_float(memory_, at, slope);
      put_float(memory_, at + 4, offset);
    }
  }
}

void FsPlusEmulator::power_up(std::int64_t now_ns) {
  stop(now_ns);
  scan_.power_up();
  ranges_.fill(0);
  tristate_ = 0xFF;
  latch_ = 0;
  edges_.clear();
  power_up_ns_ = now_ns;
}

std::optional<bool> FsPlusEmulator::digital_output(unsigned bit) const {
  if ((tristate_ >> bit & 1U) != 0) return std::nullopt;
  return (latch_ >> bit & 1U) != 0;
}

void FsPlusEmulator::note_edge(std::int64_t now_ns) {
  if (loop_back_) edges_.emplace_back(scan_.feed().next_tick_s(now_ns), digital_output(loop_back_->first).value_or(false));
}

void FsPlusEmulator::mix_loop_back(double time_s, std::span<double> volts) const {
  if (!loop_back_) return;
  bool is_high = false;
  for (const auto& [edge_s, level] : edges_) {
    if (edge_s <= time_s) is_high = level;
  }
  volts[loop_back_->second] = is_high ? kLoopHighV : 0.0;
}

std::uint16_t FsPlusEmulator::code_of(std::size_t input, std::uint8_t range_code, double volts) const {
  const auto [slope, offset] = calibration(range_code, input);
  return to_code(volts, parts_.has_records_per_range ? range_of(range_code) : 10.0, parts_.bits, slope, offset);
}

ControlReply FsPlusEmulator::control(const Setup& setup, std::span<const std::uint8_t> out_data, std::int64_t now_ns) {
  if (faults.is_mute) return silent();
  if (faults.silent_control_requests > 0) {
    --faults.silent_control_requests;
    return silent();
  }
  if (setup.request_type == 0xC0) return read_request(setup, now_ns);
  if (setup.request_type == 0x40) return write_request(setup, out_data, now_ns);
  return refused();
}

ControlReply FsPlusEmulator::read_request(const Setup& setup, std::int64_t now_ns) {
  switch (setup.request) {
    case 0x00: return done({parts_.has_port_direction ? static_cast<std::uint8_t>(tristate_ != 0 ? 1 : 0) : tristate_});
    case 0x01: return done({static_cast<std::uint8_t>(latch_ & ~tristate_)});
    case 0x02: return done({latch_});
    case 0x10: return read_input(setup, now_ns);
    case 0x14: return parts_.has_range_list && !scan_.is_running() ? done({ranges_.begin(), ranges_.end()}) : refused();
    case 0x20: return done({0, 0, 0, 0});
    case 0x30: return read_memory(setup);
    case 0x44: return done_u16((scan_.is_running() || armed_ ? 2U : 0U) | (scan_.is_overrun() ? 4U : 0U));
    case 0x48: return done({serial_.begin(), serial_.end()});
    default: return refused();
  }
}

ControlReply FsPlusEmulator::write_request(const Setup& setup, std::span<const std::uint8_t> data, std::int64_t now_ns) {
  switch (setup.request) {
    case 0x00: return set_direction(setup, now_ns);
    case 0x02:
      latch_ = static_cast<std::uint8_t>(setup.value);
      note_edge(now_ns);
      return done();
    case 0x11: return start_request(data, now_ns);
    case 0x12: stop(now_ns); return done();
    case 0x14: return set_ranges(data);
    case 0x15: scan_.clear_fifo(); return done();
    case 0x20:
    case 0x41: return done();
    case 0x42: wants_to_leave_ = true; return done();
    case 0x44: scan_.clear_errors(); return done();
    case 0x30:
    case 0x31:
    case 0x32:
    case 0x48:
    case 0x50: ++forbidden_requests; return refused();
    default: return refused();
  }
}

ControlReply FsPlusEmulator::read_memory(const Setup& setup) const {
  const std::size_t size = std::min(kMemoryBytes, faults.calibration_bytes);
  if (setup.value >= kMemoryBytes) return refused();
  const std::size_t begin = std::min<std::size_t>(setup.value, size);
  const std::size_t count = std::min<std::size_t>(setup.length, size - begin);
  if (faults.is_calibration_garbage) return done(std::vector<std::uint8_t>(count, 0xFF));
  const auto first = memory_.begin() + static_cast<std::ptrdiff_t>(begin);
  return done({first, first + static_cast<std::ptrdiff_t>(count)});
}

ControlReply FsPlusEmulator::read_input(const Setup& setup, std::int64_t now_ns) {
  if (scan_.is_running() || setup.value >= kInputs) return refused();
  const double time_s = static_cast<double>(now_ns - power_up_ns_) * 1e-9;
  return done_u16(code_of(setup.value, static_cast<std::uint8_t>(setup.index), scan_.feed().look(time_s)[setup.value]));
}

ControlReply FsPlusEmulator::set_direction(const Setup& setup, std::int64_t now_ns) {
  if (parts_.has_port_direction && setup.index != 0) return done();  // port B: not modelled
  tristate_ = static_cast<std::uint8_t>(setup.value);
  if (parts_.has_port_direction) tristate_ = setup.value != 0 ? 0xFF : 0;
  note_edge(now_ns);
  return done();
}

ControlReply FsPlusEmulator::set_ranges(std::span<const std::uint8_t> data) {
  if (!parts_.has_range_list || scan_.is_running() || data.size() != kInputs) return refused();
  if (!ignores_ranges) std::copy(data.begin(), data.end(), ranges_.begin());
  return done();
}

std::optional<FsPlusEmulator::Start> FsPlusEmulator::parse_start(std::span<const std::uint8_t> data) const {
  if (data.size() != parts_.start_bytes) return std::nullopt;
  const std::size_t period_at = parts_.start_bytes == 14 ? 8 : 4;
  const unsigned options = data[period_at + 5];
  Start start;
  start.scans = u32_at(data, 0);
  start.period = u32_at(data, period_at);
  start.mask = data[period_at + 4];
  start.is_immediate = (options & 1U) != 0;
  start.stalls_on_overrun = (options & 0x80U) == 0;
  start.has_trigger = parts_.start_bytes == 12 ? data[10] != 0 : (options & 0x1CU) != 0;
  start.drives_sync = parts_.start_bytes == 10 && (options & 2U) != 0 && start.period != 0;
  start.counts = parts_.start_bytes == 10 && (options & 0x20U) != 0;
  if (start.mask == 0) return std::nullopt;
  return start;
}

ControlReply FsPlusEmulator::start_request(std::span<const std::uint8_t> data, std::int64_t now_ns) {
  const auto start = parse_start(data);
  if (!start || scan_.is_running() || armed_) return refused();
  last_start_.assign(data.begin(), data.end());
  scan_.clear_errors();
  if (start->has_trigger) {
    armed_ = start;
    return done();
  }
  run(*start, now_ns);
  if (failing_starts > 0) {
    --failing_starts;
    scan_.overrun(now_ns);
  }
  return done();
}

void FsPlusEmulator::fire_trigger(std::int64_t now_ns) {
  if (armed_) run(*std::exchange(armed_, std::nullopt), now_ns);
}

void FsPlusEmulator::run(const Start& start, std::int64_t now_ns) {
  FeedSetup setup;
  for (std::size_t input = 0; input < kInputs; ++input) {
    if ((start.mask >> input & 1U) != 0) setup.inputs.push_back(input);
  }
  const std::size_t count = setup.inputs.size();
  setup.codes_per_tick = parts_.is_simultaneous ? count : 1;
  setup.fifo_codes = parts_.fifo_codes;
  setup.last_code = std::uint64_t{start.scans} * (parts_.start_bytes == 14 ? 1 : count);
  if (start.period != 0) setup.rate = core::Rate::create(parts_.clock_hz, std::int64_t{start.period} + 1).value();
  const ScanClock* clock = nullptr;
  if (start.period == 0) clock = sync_line_ == nullptr ? &unconnected_ : &sync_line_->pulses();
  drives_sync_ = start.drives_sync && sync_line_ != nullptr;
  if (drives_sync_) sync_line_->drive(setup.rate, (1.0 + faults.clock_error_ppm * 1e-6) * faults.rate_factor, now_ns);

  const MccPacking packing{.codes_per_packet = start.is_immediate ? count : kPacketBytes / 2,
                           .endpoint_bytes = kPacketBytes,
                           .stalls_on_overrun = start.stalls_on_overrun};
  Converter converter = [this, inputs = setup.inputs](std::size_t position, double volts) {
    return code_of(inputs[position], ranges_[inputs[position]], volts);
  };
  if (start.counts) {
    converter = [counter = std::uint16_t{0}](std::size_t, double) mutable { return counter++; };
  }
  edges_.clear();
  scan_.start(std::move(setup), std::move(converter), packing, faults, clock, now_ns);
  note_edge(now_ns);
}

void FsPlusEmulator::stop(std::int64_t now_ns) {
  armed_.reset();
  scan_.stop(now_ns);
  if (std::exchange(drives_sync_, false)) sync_line_->release(now_ns);
}

std::optional<Packet> FsPlusEmulator::take_packet(std::uint8_t endpoint, std::int64_t now_ns) {
  if (endpoint != kEndpoint || faults.is_mute) return std::nullopt;
  auto packet = scan_.take_packet(now_ns);
  if (!scan_.is_running() && std::exchange(drives_sync_, false)) sync_line_->release(now_ns);
  return packet;
}

void FsPlusEmulator::clear_halt(std::uint8_t endpoint) {
  if (endpoint == kEndpoint) scan_.clear_halt();
}

}  // namespace dts::emulator
