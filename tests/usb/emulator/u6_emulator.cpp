// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/u6_emulator.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "usb/emulator/byte_parts.h"

namespace dts::emulator {
namespace {

constexpr std::uint8_t kCommandEndpoint = 0x01;
constexpr std::uint8_t kExtended = 0xF8;
constexpr std::uint8_t kStreamActive = 48;
constexpr std::uint8_t kConfigInvalid = 50;
constexpr std::uint8_t kStreamNotRunning = 52;
constexpr std::uint8_t kSamplesInvalid = 56;
constexpr double kSkewS = 20e-6;
constexpr double kLogicThresholdV = 1.4;

// This unit's converter: a little off nominal, differently for each gain. Whole multiples of what a constant can store.
constexpr double kStored = 1.0 / 4294967296.0;
constexpr std::array kPositiveSlope = {1357768 * kStored, 135300 * kStored, 13615 * kStored, 1349 * kStored};
constexpr std::array kNegativeSlope = {-1356737 * kStored, -135528 * kStored, -13573 * kStored, -1351 * kStored};
constexpr std::array kCenter = {33523.25, 33481.5, 33602.75, 33444.0};

unsigned sum_of(std::span<const std::uint8_t> bytes) {
  unsigned sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return sum;
}

/// Puts both checksums of an extended frame in place; [1..3] and the data are there.
void seal(std::vector<std::uint8_t>& frame) {
  const unsigned sum = sum_of(std::span(frame).subspan(6));
  frame[4] = low_byte(sum);
  frame[5] = high_byte(sum);
  frame[0] = folded(sum_of(std::span(frame).subspan(1, 5)));
}

std::vector<std::uint8_t> extended_reply(std::uint8_t command, std::size_t bytes, std::uint8_t error) {
  std::vector<std::uint8_t> reply(bytes);
  reply[1] = kExtended;
  reply[2] = low_byte(static_cast<unsigned>((bytes - 6) / 2));
  reply[3] = command;
  reply[6] = error;
  return reply;
}

bool is_whole(std::span<const std::uint8_t> command) {
  if (command.size() < 2) return false;
  if (command[1] != kExtended) return command[0] == folded(sum_of(command.subspan(1)));
  if (command.size() < 8 || command.size() != 6U + 2U * command[2]) return false;
  const unsigned sum = sum_of(command.subspan(6));
  return command[0] == folded(sum_of(command.subspan(1, 5))) && command[4] == low_byte(sum) && command[5] == high_byte(sum);
}

Descriptors describe() {
  Descriptors descriptors;
  descriptors.device = {18, 1, 0x00, 0x02, 0xFF, 0xFF, 0xFF, 64, 0xD5, 0x0C, 0x06, 0x00, 0x00, 0x00, 1, 2, 0, 1};
  // No serial number string: the vendor's own software opens every unit and asks ConfigU6 for it.
  const auto endpoint = [](std::uint8_t address) { return std::array<std::uint8_t, 7>{7, 5, address, 2, 64, 0, 0}; };
  descriptors.configuration = {9, 2, 39, 0, 1, 1, 0, 0x80, 250, 9, 4, 0, 0, 3, 0xFF, 0xFF, 0xFF, 0};
  for (const std::uint8_t address : {kCommandEndpoint, std::uint8_t{0x82}, std::uint8_t{0x83}}) {
    const auto one = endpoint(address);
    descriptors.configuration.insert(descriptors.configuration.end(), one.begin(), one.end());
  }
  descriptors.strings = {"LabJack Corporation", "LabJack U6"};
  return descriptors;
}

/// All sixteen numbers of ReadCal blocks 0 to 3 in their order.
std::array<double, 16> calibration() {
  std::array<double, 16> values{};
  for (std::size_t gain = 0; gain < 4; ++gain) {
    values[2 * gain] = kPositiveSlope[gain];
    values[2 * gain + 1] = -kPositiveSlope[gain] * kCenter[gain];
    values[8 + 2 * gain] = kNegativeSlope[gain];
    values[8 + 2 * gain + 1] = kCenter[gain];
  }
  return values;
}

}  // namespace

U6Emulator::U6Emulator(Source source, Identity identity)
    : descriptors_(describe()),
      identity_(identity),
      feed_(
          [source = std::move(source)](double time_s, std::span<double> volts) {
            source(time_s, volts);
            volts[kGround] = 0.0;
          },
          kInputCount) {}

std::uint16_t U6Emulator::code(std::size_t gain, double volts) noexcept {
  const double raw = volts >= 0.0 ? kCenter[gain] + volts / kPositiveSlope[gain] : kCenter[gain] - volts / kNegativeSlope[gain];
  return static_cast<std::uint16_t>(std::lround(std::clamp(raw, 0.0, 65535.0)));
}

double U6Emulator::step_v(std::size_t gain) noexcept { return kPositiveSlope[gain]; }

std::uint16_t U6Emulator::convert(std::size_t position, double volts) const noexcept {
  const std::size_t channel = scan_.channels[position];
  if (channel == 193) return volts > kLogicThresholdV ? 0xFFFF : 0xFFFE;
  if (channel >= 194) return 0xFFFF;
  return code(scan_.gains[position], volts);
}

std::size_t U6Emulator::fifo_samples() const noexcept { return scan_.samples_per_packet == 25 ? kLargeFifoSamples : kSmallFifoSamples; }

void U6Emulator::power_up(std::int64_t now_ns) {
  feed_.stop(now_ns);
  is_configured_ = is_streaming_ = is_halted_ = false;
  calibration_bytes_sent_ = 0;
  replies_.clear();
  stale_.clear();
  waiting_.clear();
}

ControlReply U6Emulator::control(const Setup&, std::span<const std::uint8_t>, std::int64_t) {
  return {ReplyKind::Stall, {}};  // it has no vendor requests: everything goes through the bulk endpoints
}

void U6Emulator::answer(Bytes reply) {
  reply.resize(std::min(reply.size(), quirks.reply_bytes));
  if (answers_++ == quirks.reply_to_damage) reply.back() = static_cast<std::uint8_t>(reply.back() ^ 0x10U);
  replies_.push_back(std::move(reply));
}

void U6Emulator::bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (endpoint != kCommandEndpoint) return;
  ++commands_;
  if (faults.is_mute) return;
  if (faults.silent_control_requests > 0) {
    --faults.silent_control_requests;
    return;
  }
  if (!is_whole(bytes)) return answer({0xB8, 0xB8});
  if (bytes[1] == kExtended) return run_extended(bytes);
  run_normal(bytes, now_ns);
}

void U6Emulator::run_normal(std::span<const std::uint8_t> command, std::int64_t now_ns) {
  Bytes reply(4);
  switch (command[1]) {
    case 0xA8:
      reply[1] = 0xA9;
      reply[2] = start_stream(now_ns);
      break;
    case 0xB0:
      reply[1] = 0xB1;
      reply[2] = stop_stream(now_ns);
      break;
    default: return answer({0xB8, 0xB8});
  }
  reply[0] = folded(sum_of(std::span(reply).subspan(1)));
  answer(std::move(reply));
}

void U6Emulator::run_extended(std::span<const std::uint8_t> command) {
  const std::uint8_t busy = is_streaming_ ? kStreamActive : std::uint8_t{0};
  switch (command[3]) {
    case 0x08: return configure_unit();
    case 0x2D: return read_calibration(command[7]);
    case 0x0B: {
      Bytes reply = extended_reply(0x0B, 16, busy);
      seal(reply);
      return answer(std::move(reply));
    }
    case 0x11: {
      Bytes reply = extended_reply(0x11, 8, configure_stream(command));
      seal(reply);
      return answer(std::move(reply));
    }
    default: return answer({0xB8, 0xB8});
  }
}

void U6Emulator::configure_unit() {
  Bytes reply = extended_reply(0x08, 38, 0);
  reply[9] = identity_.firmware_minor;
  reply[10] = identity_.firmware_major;
  reply[12] = 1;
  reply[14] = 2;
  for (unsigned i = 0; i < 4; ++i) reply[15 + i] = static_cast<std::uint8_t>(identity_.serial >> (8U * i));
  reply[19] = 6;
  reply[21] = 1;
  reply[37] = identity_.is_pro ? 12 : 4;
  seal(reply);
  answer(std::move(reply));
}

void U6Emulator::read_calibration(std::uint8_t block) {
  Bytes reply = extended_reply(0x2D, 40, is_streaming_ ? kStreamActive : std::uint8_t{0});
  const auto values = calibration();
  for (std::size_t i = 0; i < 4 && block < 4; ++i) {
    const auto fixed = static_cast<std::uint64_t>(std::llround(values[4 * block + i] * 4294967296.0));
    for (unsigned byte = 0; byte < 8; ++byte) reply[8 + 8 * i + byte] = static_cast<std::uint8_t>(fixed >> (8U * byte));
  }
  if (faults.is_calibration_garbage) std::fill(reply.begin() + 8, reply.end(), std::uint8_t{0xFF});
  seal(reply);
  const std::size_t left = faults.calibration_bytes - std::min(calibration_bytes_sent_, faults.calibration_bytes);
  calibration_bytes_sent_ += 32;
  if (left < 32) reply.resize(8 + left);
  answer(std::move(reply));
}

std::uint8_t U6Emulator::configure_stream(std::span<const std::uint8_t> command) {
  if (is_streaming_) return kStreamActive;
  is_configured_ = false;
  const std::size_t count = command[6];
  const auto interval = command.size() >= 14 ? static_cast<unsigned>(command[12]) + 256U * command[13] : 0U;
  if (count < 1 || count > 25 || command.size() != 14 + 2 * count || command[7] > 8 || interval == 0) return kConfigInvalid;
  if (command[8] < 1 || command[8] > 25) return kSamplesInvalid;
  Scan scan;
  scan.samples_per_packet = command[8];
  const std::int64_t clock_hz = (command[11] & 0x08U) != 0 ? 48'000'000 : 4'000'000;
  scan.rate = *core::Rate::create(clock_hz, std::int64_t{interval} * ((command[11] & 0x02U) != 0 ? 256 : 1));
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t channel = command[14 + 2 * i];
    if (channel > 15 && channel != 193 && channel != 194) return kConfigInvalid;
    scan.channels.push_back(channel);
    scan.gains.push_back((command[15 + 2 * i] >> 4U) & 3U);
  }
  scan_ = std::move(scan);
  is_configured_ = true;
  return 0;
}

std::uint8_t U6Emulator::start_stream(std::int64_t now_ns) {
  if (is_streaming_) return kStreamActive;
  if (!is_configured_) return kConfigInvalid;
  FeedSetup setup;
  setup.rate = scan_.rate;
  setup.codes_per_tick = scan_.channels.size();
  setup.skew_s = kSkewS;
  setup.fifo_codes = fifo_samples();
  for (const std::size_t channel : scan_.channels) setup.inputs.push_back(channel < kFio0 ? channel : kFio0);
  feed_.start(
      std::move(setup), [this](std::size_t position, double volts) { return convert(position, volts); }, faults, now_ns);
  waiting_.clear();
  stale_.clear();
  keep_until_.reset();
  discarded_.reset();
  forced_loss_scans_ = 0;
  is_overlapping_ = false;
  counter_ = 0;
  is_streaming_ = true;
  return 0;
}

std::uint8_t U6Emulator::stop_stream(std::int64_t now_ns) {
  if (!is_streaming_) return kStreamNotRunning;
  const bool keeps_data = faults.keeps_endpoint_buffer || (identity_.firmware_major == 0 && identity_.firmware_minor < 94);
  const bool was_halted = std::exchange(is_halted_, false);  // what the FIFO holds stays behind the halt
  while (keeps_data && stale_.size() < 3) {
    auto packet = take_stream_packet(now_ns);
    if (!packet) break;
    stale_.push_back(std::move(packet->bytes));
  }
  is_halted_ = was_halted;
  feed_.stop(now_ns);
  is_streaming_ = false;
  return 0;
}

}  // namespace dts::emulator
