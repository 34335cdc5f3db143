// SPDX-License-Identifier: Apache-2.0
#include "board/fake_board.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/clock.h"

namespace dts::test {
namespace {

using namespace device::board;

constexpr std::size_t kOutBytes = 1U << 16U;  // what a system keeps for a port that nobody reads
constexpr float kScale = 5.0F / 32767.0F;
constexpr std::uint32_t kTicksPerSecond = 1'000'000;
constexpr std::int64_t kDescribeEveryNs = 5 * core::kNanosecondsPerSecond;

/// A payload in work.
struct Payload {
  std::array<std::uint8_t, 256> bytes{};
  std::size_t length = 0;

  explicit Payload(FrameType type) { u8(static_cast<std::uint8_t>(type)); }
  void u8(std::uint8_t value) { bytes[length++] = value; }
  void u32(std::uint32_t value) {
    for (unsigned i = 0; i < 4; ++i) u8(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  void i16(std::int16_t value) {
    u8(static_cast<std::uint8_t>(static_cast<std::uint16_t>(value)));
    u8(static_cast<std::uint8_t>(static_cast<std::uint16_t>(value) >> 8U));
  }
  void text(std::string_view text) {
    u8(static_cast<std::uint8_t>(text.size()));
    for (const char c : text) u8(static_cast<std::uint8_t>(c));
  }
  [[nodiscard]] std::span<const std::uint8_t> view() const { return {bytes.data(), length}; }
};

std::uint32_t u32_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

}  // namespace

std::int16_t fake_code(std::uint8_t run, std::uint32_t counter, std::size_t channel) noexcept {
  if (channel == 0) return static_cast<std::int16_t>(counter & 0x7FFFU);
  if (channel == 1) return static_cast<std::int16_t>(run + 1);
  if (channel == 3) return static_cast<std::int16_t>((counter >> 15U) & 0x7FFFU);
  std::uint32_t hash = counter * 2654435761U + run * 40503U + static_cast<std::uint32_t>(channel) * 97U;
  hash ^= hash >> 15U;
  hash *= 2246822519U;
  hash ^= hash >> 13U;
  return static_cast<std::int16_t>(hash & 0x7FFFU);
}

double fake_value(std::int16_t code) noexcept { return static_cast<double>(std::fma(static_cast<float>(code), kScale, 0.0F)); }

FakeBoard::FakeBoard(FakeBoardSetup setup, std::int64_t now_ns) : setup_(std::move(setup)) {
  out_.reserve(kOutBytes);
  codes_.reserve(256);
  reset(now_ns);
}

void FakeBoard::reset(std::int64_t now_ns) {
  drop_output();
  ++run_;  // as with a count of boots in the EEPROM
  rate_ = setup_.rate;
  boot_ns_ = now_ns;
  is_streaming_ = false;
  is_pattern_ = false;
  codes_.clear();
  counter_ = first_counter_ = 0;
  decoder_.restart();
  next_descriptor_ns_ = now_ns;
  if (setup_.speaks_lines || !setup_.starts_on_command) start({}, now_ns);
  if (setup_.speaks_lines) return;
  send_bytes(std::array<std::uint8_t, 1>{0});
}

void FakeBoard::start(WireRate wanted, std::int64_t now_ns) {
  if (wanted.is_known() && !setup_.keeps_rate) rate_ = wanted;
  is_streaming_ = true;
  has_lost_ = false;
  ++run_;
  counter_ = first_counter_ = 0;
  codes_.clear();
  run_start_ns_ = now_ns;
}

std::int64_t FakeBoard::scan_ns(std::uint64_t scan) const noexcept {
  const double period_ns = 1e9 / rate_.hz() / (1.0 + setup_.clock_ppm * 1e-6);
  return run_start_ns_ + static_cast<std::int64_t>(static_cast<double>(scan + 1) * period_ns);
}

std::size_t FakeBoard::frame_scans() const noexcept {
  const auto in_time = static_cast<std::size_t>(rate_.hz() * 0.05);
  const std::size_t in_frame = (kMostPayload - 11) / 2 / setup_.channels;
  return std::clamp<std::size_t>(in_time, 1, std::min(setup_.scans_per_frame, in_frame));
}

std::int64_t FakeBoard::next_event_ns() const noexcept {
  const std::int64_t scan = is_streaming_ ? scan_ns(counter_ - first_counter_) : std::numeric_limits<std::int64_t>::max();
  return setup_.speaks_lines ? scan : std::min(scan, next_descriptor_ns_);
}

void FakeBoard::run_until(std::int64_t now_ns) {
  while (next_event_ns() <= now_ns) {
    const std::int64_t at_ns = next_event_ns();
    const bool is_silent = setup_.silent_at_s && is_streaming_ && static_cast<double>(at_ns - run_start_ns_) * 1e-9 >= *setup_.silent_at_s;
    if (!setup_.speaks_lines && at_ns == next_descriptor_ns_) {
      next_descriptor_ns_ += kDescribeEveryNs;
      if (is_silent) continue;
      send_descriptor();
      if (!setup_.hears || at_ns == boot_ns_) send_channels();
      continue;
    }
    if (is_silent) {
      ++counter_;
      continue;
    }
    make_scan(at_ns);
  }
}

void FakeBoard::make_scan(std::int64_t at_ns) {
  const double since_start_s = static_cast<double>(at_ns - run_start_ns_) * 1e-9;
  if (setup_.loses_at_s && !has_lost_ && since_start_s >= *setup_.loses_at_s) {
    has_lost_ = true;
    send_frame();
    counter_ += setup_.lost_scans;
    send_lost(LostReason::BufferFull, setup_.lost_scans);
    return;
  }
  ++scans_made_;
  if (setup_.speaks_lines) {
    send_line(at_ns);
    ++counter_;
    return;
  }
  if (codes_.empty()) {
    frame_counter_ = counter_;
    frame_ticks_ = static_cast<std::uint32_t>(static_cast<double>(at_ns - boot_ns_) * 1e-3 * (1.0 + setup_.clock_ppm * 1e-6));
  }
  for (std::size_t channel = 0; channel < setup_.channels; ++channel) {
    const std::int16_t pattern = static_cast<std::int16_t>((counter_ * 7U + channel * 1000U) % 32768U);
    const bool is_constant = static_cast<int>(channel) == setup_.constant_channel;
    codes_.push_back(is_pattern_ ? pattern : is_constant ? std::int16_t{12345} : fake_code(run_, counter_, channel));
  }
  ++counter_;
  if (codes_.size() == frame_scans() * setup_.channels) send_frame();
}

void FakeBoard::send_frame() {
  if (codes_.empty()) return;
  Payload payload(FrameType::Scans);
  payload.u8(run_);
  payload.u32(frame_counter_);
  payload.u32(frame_ticks_);
  payload.u8(static_cast<std::uint8_t>(codes_.size() / setup_.channels));
  for (const std::int16_t code : codes_) payload.i16(code);
  codes_.clear();
  send_payload(payload.view());
}

void FakeBoard::send_line(std::int64_t at_ns) {
  std::array<char, 1024> text{};
  std::size_t length = 0;
  const auto add = [&](const char* format, auto value) {
    length += static_cast<std::size_t>(std::snprintf(text.data() + length, text.size() - length, format, value));
  };
  const std::uint32_t mask = setup_.counter_bits == 16 ? 0xFFFFU : 0xFFFFFFFFU;
  if (setup_.has_counter) add("%u", counter_ & mask);
  if (setup_.has_time)
    add("%u", static_cast<std::uint32_t>(static_cast<double>(at_ns - boot_ns_) * 1e-3 * (1.0 + setup_.clock_ppm * 1e-6)));
  for (std::size_t channel = 0; channel < setup_.channels; ++channel) {
    if (length > 0) add("%s", setup_.separator.data());
    add("%.17g", fake_value(fake_code(run_, counter_, channel)));
  }
  if (setup_.has_checksum) {
    unsigned sum = 0;
    for (std::size_t i = 0; i < length; ++i) sum ^= static_cast<unsigned char>(text[i]);
    add("*%02X", sum);
  }
  add("%s", setup_.line_end.data());
  send_bytes({reinterpret_cast<const std::uint8_t*>(text.data()), length});
}

void FakeBoard::send_bytes(std::span<const std::uint8_t> bytes) {
  if (taken_ == out_.size()) drop_output();
  if (out_.size() + bytes.size() > kOutBytes) {
    out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(taken_));
    taken_ = 0;
  }
  if (out_.size() + bytes.size() > kOutBytes) return;  // lost on the way
  out_.insert(out_.end(), bytes.begin(), bytes.end());
}

void FakeBoard::send_payload(std::span<const std::uint8_t> payload) { send_bytes(encode_frame(payload).view()); }

std::size_t FakeBoard::take(std::span<std::uint8_t> out) noexcept {
  const std::size_t count = std::min(out.size(), out_.size() - taken_);
  std::copy_n(out_.begin() + static_cast<std::ptrdiff_t>(taken_), count, out.begin());
  taken_ += count;
  return count;
}

void FakeBoard::send_descriptor() {
  Payload payload(FrameType::Descriptor);
  payload.u8(setup_.version);
  payload.u8(static_cast<std::uint8_t>(setup_.channels));
  payload.u8(15);
  payload.u32(setup_.knows_rate ? rate_.numerator : 0);
  payload.u32(setup_.knows_rate ? rate_.denominator : 1);
  payload.u32(kTicksPerSecond);
  payload.u8(static_cast<std::uint8_t>((setup_.carries_time ? 1 : 0) | (setup_.starts_on_command ? 2 : 0) | (is_pattern_ ? 4 : 0) |
                                       (is_streaming_ ? 8 : 0)));
  payload.text(setup_.serial);
  payload.text("Fake board");
  payload.text("1.0");
  send_payload(payload.view());
}

void FakeBoard::send_channels() {
  for (std::size_t channel = 0; channel < setup_.channels; ++channel) {
    const bool is_constant = static_cast<int>(channel) == setup_.constant_channel;
    Payload payload(FrameType::Channel);
    payload.u8(static_cast<std::uint8_t>(channel));
    const bool is_digital = static_cast<int>(channel) == setup_.digital_channel;
    payload.u8(static_cast<std::uint8_t>((is_constant ? 1 : 0) | (is_digital ? 2 : 0)));
    payload.i16(is_constant ? std::int16_t{12345} : std::int16_t{0});
    payload.i16(is_constant ? std::int16_t{12345} : std::int16_t{32767});
    payload.u32(std::bit_cast<std::uint32_t>(setup_.scale));
    payload.u32(0);
    std::array<char, 8> name{};
    std::snprintf(name.data(), name.size(), "a%u", static_cast<unsigned>(channel));
    payload.text(name.data());
    payload.text(is_digital ? "" : "V");
    send_payload(payload.view());
  }
}

void FakeBoard::send_lost(LostReason reason, std::uint32_t lost, std::uint32_t ahead) {
  if (setup_.speaks_lines) return;
  Payload payload(FrameType::Lost);
  payload.u8(run_);
  payload.u32(counter_ + ahead);
  payload.u8(static_cast<std::uint8_t>(reason));
  payload.u32(lost);
  send_payload(payload.view());
}

void FakeBoard::send_log(std::string_view text) {
  Payload payload(FrameType::Log);
  for (const char c : text) payload.u8(static_cast<std::uint8_t>(c));
  send_payload(payload.view());
}

void FakeBoard::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  run_until(now_ns);
  if (!setup_.hears || setup_.speaks_lines) return;
  while (!bytes.empty()) {
    const FrameDecoder::Taken taken = decoder_.take(bytes);
    if (taken.has_piece()) handle(taken.payload, now_ns);
    bytes = bytes.subspan(taken.used);
  }
}

void FakeBoard::handle(std::span<const std::uint8_t> payload, std::int64_t now_ns) {
  const bool is_silent = setup_.silent_at_s && is_streaming_ && static_cast<double>(now_ns - run_start_ns_) * 1e-9 >= *setup_.silent_at_s;
  if (is_silent) return;
  switch (static_cast<FrameType>(payload[0])) {
    case FrameType::Describe: send_descriptor(); return send_channels();
    case FrameType::Start:
      if (payload.size() != 9) return;
      if (setup_.starts_on_command && !is_streaming_) start({u32_at(payload, 1), u32_at(payload, 5)}, now_ns);
      return send_descriptor();
    case FrameType::Stop:
      if (setup_.starts_on_command && is_streaming_) {
        send_frame();
        is_streaming_ = false;
        is_pattern_ = false;
        send_lost(LostReason::Stopped, 0);
      }
      return send_descriptor();
    case FrameType::Pattern:
      is_pattern_ = payload.size() == 2 && payload[1] != 0;
      codes_.clear();
      return send_descriptor();
    default: return;
  }
}

}  // namespace dts::test
