// SPDX-License-Identifier: Apache-2.0
#include "device/labjack/u6_stream.h"

#include <algorithm>

#include "device/labjack/u6_frames.h"

namespace dts::device::labjack {
namespace {

using core::GapReason;

constexpr std::uint16_t kDummy = 0xFFFF;
constexpr std::size_t kCounterAt = 10;
constexpr std::size_t kErrorAt = 11;

enum : std::uint8_t {
  kNoError = 0,
  kConverterOverflow = 54,
  kScanOverlap = 55,
  kRecoveryActive = 59,
  kRecoveryReport = 60,
  kRecoveryOverflow = 63,
};

}  // namespace

void StreamParser::restart(std::size_t channels, std::size_t samples_per_packet) noexcept {
  channels_ = std::clamp<std::size_t>(channels, 1, kMaximumSamplesPerPacket);
  samples_ = std::clamp<std::size_t>(samples_per_packet, 1, kMaximumSamplesPerPacket);
  packet_bytes_ = kHeaderBytes + 2 * samples_ + 2;
  held_bytes_ = 0;
  is_examined_ = false;
  taken_ = 0;
  phase_ = 0;
  next_counter_.reset();
  dummy_at_.reset();
  dummy_left_ = 0;
  is_recovering_.store(false, std::memory_order_relaxed);
}

usb::Unpacked StreamParser::unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept {
  usb::Unpacked result;
  while (true) {
    const auto rest = bytes.subspan(result.bytes);
    const std::size_t missing = packet_bytes_ - held_bytes_;
    std::copy_n(rest.begin(), std::min(missing, rest.size()), held_.begin() + static_cast<std::ptrdiff_t>(held_bytes_));
    if (rest.size() < missing) {
      held_bytes_ += rest.size();
      result.bytes = bytes.size();
      return result;
    }
    const auto packet = std::span<const std::uint8_t>(held_).first(packet_bytes_);
    if (!is_examined_) result.fault = examine(packet);
    is_examined_ = true;
    const bool is_done = result.fault != GapReason::None || deliver(packet, codes, result);
    if (!is_done) return result;  // the packet stays in `held_` until all its samples are written
    result.bytes += missing;
    held_bytes_ = 0;
    is_examined_ = false;
    taken_ = 0;
    if (result.fault != GapReason::None) return result;
  }
}

GapReason StreamParser::examine(std::span<const std::uint8_t> packet) noexcept {
  const bool is_sound = packet[1] == 0xF9 && packet[2] == 4 + samples_ && packet[3] == 0xC0 && has_right_checksums(packet);
  if (!is_sound) return GapReason::Integrity;
  if (next_counter_ && packet[kCounterAt] != *next_counter_) return GapReason::Integrity;
  next_counter_ = static_cast<std::uint8_t>(packet[kCounterAt] + 1);
  if (!pass_over_dummy(packet)) return GapReason::Integrity;
  return examine_error(packet);
}

GapReason StreamParser::examine_error(std::span<const std::uint8_t> packet) noexcept {
  switch (packet[kErrorAt]) {
    case kNoError: return GapReason::None;
    case kRecoveryActive: is_recovering_.store(true, std::memory_order_relaxed); return GapReason::None;
    case kRecoveryReport: break;
    case kConverterOverflow:
    case kScanOverlap:
    case kRecoveryOverflow: return GapReason::Overrun;
    default: return GapReason::Integrity;
  }
  is_recovering_.store(false, std::memory_order_relaxed);
  // Some programs of the vendor use 16 bits for this count, some 32. It is used only if both readings agree.
  discarded_ = packet[6] + 256U * packet[7];
  const bool is_count_believable = discarded_ > 0 && packet[8] == 0 && packet[9] == 0;
  return is_count_believable && find_dummy(packet) ? GapReason::None : GapReason::Overrun;
}

bool StreamParser::find_dummy(std::span<const std::uint8_t> packet) noexcept {
  for (std::size_t start = taken_ + (channels_ - phase_) % channels_; start < samples_; start += channels_) {
    const std::size_t end = std::min(start + channels_, samples_);
    std::size_t i = start;
    while (i < end && sample(packet, i) == kDummy) ++i;
    if (i < end) continue;
    dummy_at_ = start;
    return true;
  }
  return false;
}

bool StreamParser::pass_over_dummy(std::span<const std::uint8_t> packet) noexcept {
  const std::size_t count = std::min(dummy_left_, samples_);
  for (; taken_ < count; ++taken_) {
    if (sample(packet, taken_) != kDummy) return false;
  }
  dummy_left_ -= count;
  return true;
}

std::uint16_t StreamParser::sample(std::span<const std::uint8_t> packet, std::size_t index) noexcept {
  return static_cast<std::uint16_t>(packet[kHeaderBytes + 2 * index] | packet[kHeaderBytes + 2 * index + 1] << 8);
}

bool StreamParser::deliver(std::span<const std::uint8_t> packet, std::span<std::uint16_t> codes, usb::Unpacked& result) noexcept {
  const std::size_t end = dummy_at_.value_or(samples_);
  while (taken_ < end && result.codes < codes.size()) {
    codes[result.codes++] = sample(packet, taken_++);
    phase_ = phase_ + 1 == channels_ ? 0 : phase_ + 1;
  }
  if (taken_ < end) return false;
  if (!dummy_at_) return true;
  dummy_at_.reset();
  taken_ = std::min(end + channels_, samples_);
  dummy_left_ = channels_ - (taken_ - end);
  result.fault = GapReason::Overrun;
  result.goes_on = true;
  result.discarded_scans = discarded_;
  return taken_ == samples_;
}

}  // namespace dts::device::labjack
