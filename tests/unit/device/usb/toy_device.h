// SPDX-License-Identifier: Apache-2.0
// A DAQ that exists nowhere: small, and every sample says which one it is.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/rate.h"
#include "usb/emulator/emulated_device.h"
#include "usb/emulator/faults.h"

namespace dts::device::usb::test {

inline constexpr std::uint8_t kToyEndpoint = 0x81;
inline constexpr std::size_t kToyPacketBytes = 64;
inline constexpr std::uint16_t kToyVendor = 0x1209;
inline constexpr std::uint16_t kToyProduct = 0x0001;
inline constexpr std::uint16_t kToyMarkerCode = 40'000;
inline constexpr std::uint16_t kToyGapCode = 0xFFFF;  ///< Followed by the number of scans that the device discarded.
inline constexpr std::uint16_t kToyRailCode = 0xFFFE;
inline constexpr double kToyVoltsPerCode = 1e-4;

enum ToyRequest : std::uint8_t { kToyStop = 1, kToyIdentity, kToyConfigure, kToySingle, kToyBegin, kToyStatus, kToySync };

/// The code of a channel in scan `scan` since the start; the last channel may be a marker.
inline std::uint16_t toy_code(std::size_t channel, std::uint64_t scan) {
  return static_cast<std::uint16_t>(channel * 4096U + scan % 4096U);
}

class ToyDevice final : public emulator::EmulatedDevice {
 public:
  explicit ToyDevice(std::string serial = "T1") {
    descriptors_.device = {18, 1, 0, 2, 0xFF, 0, 0, 64, kToyVendor & 0xFF, kToyVendor >> 8U, kToyProduct, 0, 0x07, 0x01, 0, 0, 1, 1};
    descriptors_.configuration = {9, 2, 25, 0, 1, 1, 0, 0x80, 50, 9, 4, 0, 0, 1, 0xFF, 0, 0, 0, 7, 5, kToyEndpoint, 2, kToyPacketBytes,
                                  0, 0};
    descriptors_.strings = {std::move(serial)};
  }

  bool has_marker = false;
  bool stalls_on_overrun = true;
  std::size_t fifo_codes = 32'768;
  std::size_t rotated_by = 0;                            ///< The scan begins with this channel.
  std::uint64_t gap_at_scan = emulator::Faults::kNever;  ///< Recovers by itself, telling that it lost `gap_scans`.
  std::uint16_t gap_scans = 0;
  std::size_t gap_channel = 0;  ///< The scan breaks off before this channel.
  std::uint64_t rail_at_code = emulator::Faults::kNever;
  double moved_v = 0.0;                                   ///< Added to channel 0's single reading: somebody moved.
  bool takes_begin_without_running = false;
  std::uint8_t hidden_serial = 0;  ///< Of a unit that does not tell it in its descriptors.
  bool is_sync_high = false;
  bool wants_out = false;
  std::uint64_t requests = 0;
  std::uint64_t begins = 0;
  bool used_large_packets = false;

  [[nodiscard]] bool is_running() const { return is_running_; }
  /// Host time of a scan's instant.
  [[nodiscard]] std::int64_t instant_ns(std::uint64_t scan) const {
    const double factor = faults.rate_factor * (1.0 + faults.clock_error_ppm * 1e-6);
    return start_ns_ + static_cast<std::int64_t>(static_cast<double>(rate_.time_ns({scan})) / factor);
  }
  /// An armed scan starts.
  void trigger(std::int64_t now_ns) {
    start_ns_ = now_ns;
    is_armed_ = false;
  }

  [[nodiscard]] const emulator::Descriptors& descriptors() const override { return descriptors_; }
  void power_up(std::int64_t) override { is_running_ = is_overrun_ = is_stalled_ = is_armed_ = false; }
  void bulk_out(std::uint8_t, std::span<const std::uint8_t>, std::int64_t) override {}
  void clear_halt(std::uint8_t) override { is_stalled_ = false; }
  [[nodiscard]] bool wants_to_leave() override { return std::exchange(wants_out, false); }

  [[nodiscard]] emulator::ControlReply control(const emulator::Setup& setup, std::span<const std::uint8_t> data,
                                               std::int64_t now_ns) override {
    if (faults.is_mute || std::exchange(faults.silent_control_requests, std::max(faults.silent_control_requests - 1, 0)) > 0) {
      return {emulator::ReplyKind::Silence, {}};
    }
    ++requests;
    switch (setup.request) {
      case kToyStop: stop(); return {};
      case kToyIdentity: return {emulator::ReplyKind::Done, std::vector<std::uint8_t>{0xCA, 0x1B, hidden_serial}};
      case kToyConfigure: return configure(data);
      case kToySingle: return single(setup.value);
      case kToyBegin: return begin(now_ns);
      case kToyStatus: return {emulator::ReplyKind::Done, {static_cast<std::uint8_t>((is_running_ ? 1U : 0U) | (is_overrun_ ? 2U : 0U))}};
      case kToySync: is_sync_high = setup.value != 0; return {};
      default: return {emulator::ReplyKind::Stall, {}};
    }
  }

  [[nodiscard]] std::optional<emulator::Packet> take_packet(std::uint8_t endpoint, std::int64_t now_ns) override {
    if (endpoint != kToyEndpoint) return std::nullopt;
    if (is_stalled_) return emulator::Packet{true, {}};
    if (!is_running_ || is_armed_ || now_ns < start_ns_) return std::nullopt;
    if (next_ >= faults.silence_at_code) return std::nullopt;
    if (codes_by(now_ns) > next_ + fifo_codes) return overrun();
    if (codes_by(now_ns) < next_ + packet_codes_ + discarded_codes()) return std::nullopt;
    if (strikes(faults.stall_at_code)) return stall();
    if (strikes(faults.overrun_at_code)) return overrun();
    if (strikes(faults.drop_packet_at_code)) {
      next_ += packet_codes_;
      return take_packet(endpoint, now_ns);
    }
    return emulator::Packet{false, make_packet()};
  }

  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const override {
    if (is_stalled_) return now_ns;
    if (!is_running_ || is_armed_ || next_ >= faults.silence_at_code) return std::numeric_limits<std::int64_t>::max();
    return instant_ns((next_ + packet_codes_ + channels_ - 1) / channels_ - 1);
  }

 private:
  void stop() {
    if (next_ >= faults.silence_at_code) faults.silence_at_code = emulator::Faults::kNever;
    is_running_ = is_overrun_ = is_stalled_ = is_armed_ = false;
  }
  /// What the next packet leaves out.
  [[nodiscard]] std::uint64_t discarded_codes() const {
    const bool is_in_packet = gap_at_scan != emulator::Faults::kNever && next_ + packet_codes_ > gap_at_scan * channels_ + gap_channel;
    return is_in_packet ? gap_scans * channels_ : 0;
  }
  [[nodiscard]] bool strikes(std::uint64_t& at) const {
    if (next_ + packet_codes_ <= at) return false;
    at = emulator::Faults::kNever;
    return true;
  }
  std::optional<emulator::Packet> stall() {
    is_stalled_ = true;
    is_running_ = false;
    return emulator::Packet{true, {}};
  }
  std::optional<emulator::Packet> overrun() {
    is_overrun_ = true;
    is_running_ = false;
    if (!stalls_on_overrun) return std::nullopt;
    return stall();
  }

  emulator::ControlReply configure(std::span<const std::uint8_t> data) {
    if (data.size() != 10 || is_running_) return {emulator::ReplyKind::Stall, {}};
    const auto word = [&data](std::size_t at) {
      return static_cast<std::int64_t>(data[at] | data[at + 1] << 8U | data[at + 2] << 16U) | static_cast<std::int64_t>(data[at + 3])
                                                                                                  << 24U;
    };
    rate_ = *core::Rate::create(word(0), word(4));
    channels_ = std::max<std::size_t>(data[8], 1);
    used_large_packets = (data[9] & 1U) != 0;
    is_triggered_ = (data[9] & 2U) != 0;
    packet_codes_ = used_large_packets ? kToyPacketBytes / 2 : channels_;
    return {};
  }
  emulator::ControlReply single(std::size_t channel) const {
    const std::uint16_t code = static_cast<std::uint16_t>(code_of(channel, 0) + (channel == 0 ? moved_v / kToyVoltsPerCode : 0.0));
    return {emulator::ReplyKind::Done, {static_cast<std::uint8_t>(code & 0xFFU), static_cast<std::uint8_t>(code >> 8U)}};
  }
  emulator::ControlReply begin(std::int64_t now_ns) {
    ++begins;
    is_running_ = !takes_begin_without_running;
    is_armed_ = is_triggered_;
    start_ns_ = now_ns;
    next_ = 0;
    return {};
  }

  [[nodiscard]] std::uint16_t code_of(std::size_t channel, std::uint64_t scan) const {
    return has_marker && channel + 1 == channels_ ? kToyMarkerCode : toy_code(channel, scan);
  }
  [[nodiscard]] std::uint64_t codes_by(std::int64_t now_ns) const {
    std::uint64_t scans = static_cast<std::uint64_t>(static_cast<double>(now_ns - start_ns_) * 1e-9 * rate_.hz() * faults.rate_factor);
    while (instant_ns(scans) <= now_ns) ++scans;
    while (scans > 0 && instant_ns(scans - 1) > now_ns) --scans;
    return scans * channels_;
  }

  std::vector<std::uint8_t> make_packet() {
    std::vector<std::uint8_t> bytes;
    bytes.reserve(2 * packet_codes_ + 8);
    const auto put = [&bytes](std::uint16_t code) {
      bytes.push_back(static_cast<std::uint8_t>(code & 0xFFU));
      bytes.push_back(static_cast<std::uint8_t>(code >> 8U));
    };
    const bool is_short = strikes(faults.short_packet_at_code);
    const bool is_babble = strikes(faults.babble_at_code);
    for (; bytes.size() < 2 * packet_codes_; ++next_) {
      if (next_ == faults.drop_code_at) {
        faults.drop_code_at = emulator::Faults::kNever;
        ++next_;
      }
      if (next_ % channels_ == gap_channel && next_ / channels_ == gap_at_scan) {
        next_ = (gap_at_scan + gap_scans) * channels_;
        gap_at_scan = emulator::Faults::kNever;
        put(kToyGapCode);
        put(gap_scans);
      }
      if (bytes.size() >= 2 * packet_codes_) break;
      const std::uint64_t code = next_ + rotated_by;
      put(next_ == rail_at_code ? kToyRailCode : code_of(code % channels_, code / channels_));
    }
    if (is_short) bytes.pop_back();
    if (is_babble) bytes.resize(kToyPacketBytes + 2);
    return bytes;
  }

  emulator::Descriptors descriptors_;
  core::Rate rate_;
  std::size_t channels_ = 1;
  std::size_t packet_codes_ = 1;
  bool is_triggered_ = false;
  bool is_running_ = false;
  bool is_overrun_ = false;
  bool is_stalled_ = false;
  bool is_armed_ = false;
  std::int64_t start_ns_ = 0;
  std::uint64_t next_ = 0;  ///< Code to send next.
};

}  // namespace dts::device::usb::test
