// SPDX-License-Identifier: Apache-2.0
// The stream side of the emulated U6: packets, the FIFO and its auto-recovery, faults.
#include <algorithm>
#include <utility>

#include "usb/emulator/byte_parts.h"
#include "usb/emulator/u6_emulator.h"

namespace dts::emulator {
namespace {

constexpr std::uint8_t kReplyEndpoint = 0x82;
constexpr std::uint8_t kStreamEndpoint = 0x83;
constexpr std::size_t kHeaderBytes = 12;
constexpr std::size_t kTailBytes = 2;
constexpr std::size_t kU6BabbleBytes = 80;
constexpr std::uint16_t kDummy = 0xFFFF;
constexpr std::uint8_t kScanOverlap = 55;
constexpr std::uint8_t kRecoveryActive = 59;
constexpr std::uint8_t kRecoveryReport = 60;
constexpr std::uint8_t kRecoveryOverflow = 63;

/// A fault at a code of [first, end) strikes now, and is spent.
bool strikes(std::uint64_t& at_code, std::uint64_t first, std::uint64_t end) {
  if (at_code < first || at_code >= end) return false;
  at_code = Faults::kNever;
  return true;
}

}  // namespace

std::optional<Packet> U6Emulator::take_packet(std::uint8_t endpoint, std::int64_t now_ns) {
  std::deque<Bytes>* const ready = endpoint == kReplyEndpoint ? &replies_ : &stale_;
  if (endpoint != kReplyEndpoint && endpoint != kStreamEndpoint) return std::nullopt;
  if (endpoint == kStreamEndpoint && is_halted_ && !is_streaming_) return Packet{true, {}};
  if (!ready->empty()) {
    Packet packet{false, std::move(ready->front())};
    ready->pop_front();
    return packet;
  }
  return endpoint == kStreamEndpoint ? take_stream_packet(now_ns) : std::nullopt;
}

void U6Emulator::clear_halt(std::uint8_t endpoint) {
  if (endpoint == kStreamEndpoint) is_halted_ = false;
}

std::int64_t U6Emulator::next_packet_ns(std::int64_t now_ns) const {
  if (!replies_.empty() || !stale_.empty()) return now_ns;
  if (!is_streaming_ || is_halted_) return kNeverNs;
  const std::size_t wanted = scan_.samples_per_packet - std::min(scan_.samples_per_packet, waiting_.size());
  return std::max(paused_until_ns_, keep_until_ ? now_ns : feed_.ready_ns(wanted));
}

std::uint64_t U6Emulator::available(std::int64_t now_ns) const noexcept {
  const std::uint64_t of_feed = feed_.available(now_ns);
  return waiting_.size() + (keep_until_ ? std::min(of_feed, *keep_until_ - feed_.position()) : of_feed);
}

/// Full FIFO: what it holds will be sent, what comes is discarded until less than a packet is left (U3 data sheet 5.2.12; the
/// U6's says that it does the same).
void U6Emulator::watch_fifo(std::int64_t now_ns) {
  if (keep_until_) return;
  const std::uint64_t channels = scan_.channels.size();
  const std::uint64_t first = feed_.position();
  if (feed_.is_over_limit(now_ns)) {
    keep_until_ = (first + fifo_samples()) / channels * channels;
  } else if (const std::uint64_t at = faults.overrun_at_code;
             available(now_ns) >= scan_.samples_per_packet && strikes(faults.overrun_at_code, first, first + scan_.samples_per_packet)) {
    keep_until_ = std::max(at / channels, (first + channels - 1) / channels) * channels;
    forced_loss_scans_ = kForcedLossScans;
  }
  resume_when_drained(now_ns);
}

void U6Emulator::resume_when_drained(std::int64_t now_ns) {
  if (!keep_until_ || *keep_until_ - feed_.position() >= scan_.samples_per_packet) return;
  const std::uint64_t channels = scan_.channels.size();
  bool is_corrupt = false;  // not in the middle of an overrun
  while (feed_.position() < *keep_until_) waiting_.push_back(take_code(is_corrupt));
  const std::uint64_t by_time = feed_.available(now_ns) / channels;
  const std::uint64_t lost = std::max({by_time, std::exchange(forced_loss_scans_, 0), std::uint64_t{1}});
  feed_.skip(lost * channels);
  if (quirks.has_dummy_scan) waiting_.insert(waiting_.end(), channels, kDummy);
  discarded_ = lost;
  keep_until_.reset();
}

std::uint16_t U6Emulator::take_code(bool& is_corrupt) {
  // The feed would turn the code's bits; here the packet is damaged after its checksum was made.
  if (feed_.position() == faults.corrupt_at_code) {
    faults.corrupt_at_code = Faults::kNever;
    is_corrupt = true;
  }
  return feed_.take();
}

std::vector<std::uint16_t> U6Emulator::take_samples(bool& is_corrupt) {
  std::vector<std::uint16_t> samples;
  while (samples.size() < scan_.samples_per_packet && !waiting_.empty()) {
    samples.push_back(waiting_.front());
    waiting_.pop_front();
  }
  while (samples.size() < scan_.samples_per_packet) samples.push_back(take_code(is_corrupt));
  return samples;
}

U6Emulator::Bytes U6Emulator::make_packet(std::span<const std::uint16_t> samples, std::uint8_t error, std::uint64_t discarded,
                                          std::int64_t now_ns) {
  Bytes packet(kHeaderBytes + 2 * samples.size() + kTailBytes);
  packet[1] = 0xF9;
  packet[2] = static_cast<std::uint8_t>(4 + samples.size());
  packet[3] = 0xC0;
  for (unsigned byte = 0; byte < 4; ++byte) packet[6 + byte] = static_cast<std::uint8_t>(discarded >> (8U * byte));
  packet[10] = counter_++;
  packet[11] = error;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    packet[kHeaderBytes + 2 * i] = static_cast<std::uint8_t>(samples[i] & 0xFFU);
    packet[kHeaderBytes + 2 * i + 1] = static_cast<std::uint8_t>(samples[i] >> 8U);
  }
  packet[packet.size() - 2] = static_cast<std::uint8_t>(std::min<std::uint64_t>(255, available(now_ns) * 256 / fifo_samples()));
  unsigned sum = 0;
  for (std::size_t i = 6; i < packet.size(); ++i) sum += packet[i];
  packet[4] = static_cast<std::uint8_t>(sum & 0xFFU);
  packet[5] = static_cast<std::uint8_t>(sum >> 8U);
  packet[0] = folded(static_cast<unsigned>(packet[1]) + packet[2] + packet[3] + packet[4] + packet[5]);
  return packet;
}

std::optional<Packet> U6Emulator::take_stream_packet(std::int64_t now_ns) {
  while (is_streaming_ && !is_halted_) {
    watch_fifo(now_ns);
    if (available(now_ns) < scan_.samples_per_packet) return std::nullopt;
    const std::uint64_t first = feed_.position();
    if (strikes(faults.pause_at_code, first, first + scan_.samples_per_packet)) paused_until_ns_ = now_ns + faults.pause_ns;
    if (now_ns < paused_until_ns_) return std::nullopt;
    bool is_corrupt = false;
    const auto samples = take_samples(is_corrupt);
    const std::uint64_t end = feed_.position();

    std::uint8_t error = keep_until_ ? kRecoveryActive : std::uint8_t{0};
    std::uint64_t discarded = 0;
    if (discarded_) {
      discarded = *std::exchange(discarded_, std::nullopt);
      error = discarded > 0xFFFF ? kRecoveryOverflow : kRecoveryReport;
      if (quirks.is_discarded_count_wide) discarded |= 0x10000U;
    }
    is_overlapping_ = is_overlapping_ || strikes(quirks.scan_overlap_at_code, first, end);
    if (is_overlapping_) error = kScanOverlap;
    if (strikes(faults.skip_counter_at_code, first, end)) ++counter_;
    Bytes packet = make_packet(samples, error, discarded, now_ns);
    resume_when_drained(now_ns);

    if (is_corrupt) packet[kHeaderBytes] = static_cast<std::uint8_t>(packet[kHeaderBytes] ^ 1U);
    if (strikes(faults.drop_packet_at_code, first, end)) continue;
    if (strikes(faults.short_packet_at_code, first, end)) packet.resize(packet.size() / 2 | 1U);
    if (strikes(faults.babble_at_code, first, end)) packet.resize(kU6BabbleBytes);
    if (strikes(faults.stall_at_code, first, end)) {
      is_halted_ = true;
      return Packet{true, {}};
    }
    return Packet{false, std::move(packet)};
  }
  return std::nullopt;
}

}  // namespace dts::emulator
