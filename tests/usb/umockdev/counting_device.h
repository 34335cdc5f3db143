// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "usb/emulator/emulated_device.h"

namespace dts::emulator {

/// The simplest device that streams: endpoint 0x81 sends packets of 64 bytes, 16-bit codes counting up, one packet per millisecond
/// since a start request; endpoint 0x02 swallows. It does one wrong thing per request, at once.
class CountingDevice final : public EmulatedDevice {
 public:
  static constexpr std::uint16_t kVendor = 0x1209;  // pid.codes, for private tests
  static constexpr std::uint16_t kProduct = 0x0001;
  static constexpr std::size_t kPacketBytes = 64;
  static constexpr std::int64_t kPacketNs = 1'000'000;

  // Vendor requests.
  static constexpr std::uint8_t kStart = 0x11;
  static constexpr std::uint8_t kStop = 0x12;
  static constexpr std::uint8_t kEcho = 0x20;    ///< OUT keeps bytes, IN gives them back.
  static constexpr std::uint8_t kSilent = 0x30;  ///< Is never answered.
  static constexpr std::uint8_t kLeave = 0x42;   ///< Leaves the bus and comes back.

  /// What is wrong with the next packet, once.
  enum class Trouble : std::uint8_t { None, Short, Stall, Babble };

  /// `serial` empty: it has none.
  explicit CountingDevice(const std::string& serial = "SN0001", bool is_high_speed = false);

  Trouble trouble = Trouble::None;
  bool is_mute = false;  ///< Sends nothing, answers nothing.
  int power_ups = 0;
  std::uint64_t halts_cleared = 0;
  std::uint64_t bytes_swallowed = 0;

  [[nodiscard]] const Descriptors& descriptors() const override { return descriptors_; }
  void power_up(std::int64_t now_ns) override;
  [[nodiscard]] ControlReply control(const Setup& setup, std::span<const std::uint8_t> out_data, std::int64_t now_ns) override;
  void bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, std::int64_t now_ns) override;
  [[nodiscard]] std::optional<Packet> take_packet(std::uint8_t endpoint, std::int64_t now_ns) override;
  void clear_halt(std::uint8_t endpoint) override;
  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const override;
  [[nodiscard]] bool wants_to_leave() override;

 private:
  Descriptors descriptors_;
  std::vector<std::uint8_t> echo_;
  bool is_running_ = false;
  bool wants_to_leave_ = false;
  std::int64_t start_ns_ = 0;
  std::int64_t sent_ = 0;  ///< Packets since the start.
};

}  // namespace dts::emulator
