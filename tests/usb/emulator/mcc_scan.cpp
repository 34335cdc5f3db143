// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/mcc_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dts::emulator {
namespace {

constexpr std::size_t kMccBabbleBytes = 2;
constexpr std::size_t kMostLeftOver = 64;

void append(std::vector<std::uint8_t>& bytes, std::uint16_t code) {
  bytes.push_back(static_cast<std::uint8_t>(code));
  bytes.push_back(static_cast<std::uint8_t>(code >> 8U));
}

}  // namespace

void MccScan::start(FeedSetup setup, Converter converter, const MccPacking& packing, Faults& faults, const ScanClock* clock,
                    std::int64_t now_ns) {
  faults_ = &faults;
  packing_ = packing;
  if (clock == nullptr) {
    feed_.start(std::move(setup), std::move(converter), faults, now_ns);
  } else {
    feed_.start(std::move(setup), std::move(converter), faults, *clock, now_ns);
  }
}

void MccScan::stop(std::int64_t now_ns) {
  if (!feed_.is_running()) return;
  for (std::uint64_t i = std::min<std::uint64_t>(feed_.available(now_ns), kMostLeftOver); i > 0; --i) append(left_over_, feed_.take());
  feed_.stop(now_ns);
}

void MccScan::clear_fifo() noexcept {
  const std::size_t kept = faults_ != nullptr && faults_->keeps_endpoint_buffer ? 2 * packing_.endpoint_bytes : 0;
  left_over_.resize(std::min(left_over_.size(), kept));
}

/// The device's side of the cable is busy with something else.
bool MccScan::is_paused(std::int64_t now_ns) noexcept {
  if (strikes(faults_->pause_at_code, packing_.codes_per_packet)) paused_until_ns_ = now_ns + faults_->pause_ns;
  return now_ns < paused_until_ns_;
}

void MccScan::leave(std::uint16_t code) { append(left_over_, code); }

void MccScan::power_up() noexcept {
  feed_.stop(0);
  left_over_.clear();
  paused_until_ns_ = 0;
  is_overrun_ = false;
  is_halted_ = false;
}

void MccScan::overrun(std::int64_t now_ns) {
  feed_.stop(now_ns);
  is_overrun_ = true;
  is_halted_ = packing_.stalls_on_overrun;
}

bool MccScan::strikes(std::uint64_t& fault_at, std::size_t codes) const noexcept {
  if (fault_at < feed_.position() || fault_at >= feed_.position() + codes) return false;
  fault_at = Faults::kNever;
  return true;
}

std::optional<Packet> MccScan::take_packet(std::int64_t now_ns) {
  if (is_halted_) return Packet{.is_stall = true, .bytes = {}};
  if (!left_over_.empty()) {
    const auto end = left_over_.begin() + static_cast<std::ptrdiff_t>(std::min(left_over_.size(), packing_.endpoint_bytes));
    Packet packet{.is_stall = false, .bytes = {left_over_.begin(), end}};
    left_over_.erase(left_over_.begin(), end);
    return packet;
  }
  if (!feed_.is_running()) return std::nullopt;
  if (feed_.is_over_limit(now_ns)) {
    overrun(now_ns);
    return take_packet(now_ns);
  }
  return next_packet(now_ns);
}

std::optional<Packet> MccScan::next_packet(std::int64_t now_ns) {
  const std::size_t codes = packing_.codes_per_packet;
  if (feed_.available(now_ns) < codes) return last_packet(now_ns);
  if (is_paused(now_ns)) return std::nullopt;
  if (strikes(faults_->overrun_at_code, codes)) {
    overrun(now_ns);
    return take_packet(now_ns);
  }
  if (strikes(faults_->stall_at_code, codes)) {
    is_halted_ = true;
    return take_packet(now_ns);
  }
  if (strikes(faults_->drop_packet_at_code, codes)) {
    feed_.skip(codes * faults_->drop_packets);
    return take_packet(now_ns);
  }
  return pack(codes);
}

std::optional<Packet> MccScan::last_packet(std::int64_t now_ns) {
  const auto rest = static_cast<std::size_t>(feed_.available(now_ns));
  if (!feed_.is_last(rest)) return std::nullopt;
  Packet packet = pack(rest);  // empty when the scan ended with a full packet
  feed_.stop(now_ns);
  return packet;
}

Packet MccScan::pack(std::size_t codes) {
  const std::uint64_t first = feed_.position();
  Packet packet;
  for (std::size_t i = 0; i < codes; ++i) append(packet.bytes, feed_.take());
  damage(packet, first, static_cast<std::size_t>(feed_.position() - first));
  return packet;
}

void MccScan::damage(Packet& packet, std::uint64_t first_code, std::size_t codes) {
  const auto hits = [&](std::uint64_t& fault_at) {
    if (fault_at < first_code || fault_at >= first_code + codes) return false;
    fault_at = Faults::kNever;
    return true;
  };
  if (hits(faults_->short_packet_at_code)) packet.bytes.pop_back();
  if (hits(faults_->babble_at_code)) packet.bytes.resize(packing_.endpoint_bytes + kMccBabbleBytes);
}

std::int64_t MccScan::next_packet_ns(std::int64_t now_ns) const noexcept {
  if (is_halted_ || !left_over_.empty()) return now_ns;
  if (!feed_.is_running()) return kNeverNs;
  return std::max({now_ns, paused_until_ns_, feed_.ready_ns(feed_.remaining(packing_.codes_per_packet))});
}

std::uint16_t to_code(double volts, double range_v, unsigned bits, float slope, float offset) noexcept {
  const double full_scale = std::ldexp(1.0, static_cast<int>(bits));
  const double corrected = (volts + range_v) * full_scale / (2.0 * range_v);
  const double raw = std::round((corrected - static_cast<double>(offset)) / static_cast<double>(slope));
  return static_cast<std::uint16_t>(std::clamp(raw, 0.0, full_scale - 1.0));
}

}  // namespace dts::emulator
