// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "usb/emulator/faults.h"

namespace dts::emulator {

/// What stands at the inputs of a device: fills the voltage of every input at device time `time_s` (seconds since the scan's
/// start or, for single readings, since power-up; never goes back within one scan).
using Source = std::function<void(double time_s, std::span<double> volts)>;

/// What enumeration finds.
struct Descriptors {
  std::vector<std::uint8_t> device;         ///< 18 bytes.
  std::vector<std::uint8_t> configuration;  ///< The whole configuration: interface and endpoints behind it.
  std::vector<std::string> strings;         ///< Index 1, 2, 3, ...
  bool is_high_speed = false;
};

struct Setup {
  std::uint8_t request_type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
  std::uint16_t length = 0;
};

enum class ReplyKind : std::uint8_t {
  Done,
  Stall,
  Silence,  ///< Never answers: the host's timeout ends it.
};

/// Answer to a control transfer. `data`: of an IN request, at most Setup::length bytes count.
struct ControlReply {
  ReplyKind kind = ReplyKind::Done;
  std::vector<std::uint8_t> data;
};

/// One packet of a bulk IN endpoint, or a stalled endpoint.
struct Packet {
  bool is_stall = false;
  std::vector<std::uint8_t> bytes;  ///< May be longer than the endpoint's packet size: babble, an overflow for the host.
};

/// The inside of a USB DAQ as its maker's documents describe it, which are cited where they are followed. Byte-exact at
/// the cable, driven by a Source, with its own clock and with faults on request. It knows no host: FakeBus, UmockdevHost and
/// VhciHost put it on one. Time is told by whoever calls and never goes back. Thread: one at a time (the host locks).
class EmulatedDevice {
 public:
  virtual ~EmulatedDevice() = default;

  Faults faults;

  [[nodiscard]] virtual const Descriptors& descriptors() const = 0;
  /// The plug goes in (also after a reset that left the bus): everything volatile is as after power-up.
  virtual void power_up(std::int64_t now_ns) = 0;
  /// A request to the device other than the standard ones, which the host answers from `descriptors`.
  [[nodiscard]] virtual ControlReply control(const Setup& setup, std::span<const std::uint8_t> out_data, std::int64_t now_ns) = 0;
  virtual void bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes, std::int64_t now_ns) = 0;
  /// The next packet that the endpoint has ready at `now_ns`, or nullopt: nothing yet (NAK). A packet is handed over once.
  [[nodiscard]] virtual std::optional<Packet> take_packet(std::uint8_t endpoint, std::int64_t now_ns) = 0;
  /// The host cleared the halt of an endpoint.
  virtual void clear_halt(std::uint8_t endpoint) = 0;
  /// A time at which `take_packet` may have more than it has now; never later than the next packet that is sure to come. The
  /// largest value: nothing will come by itself.
  [[nodiscard]] virtual std::int64_t next_packet_ns(std::int64_t now_ns) const = 0;
  /// The device asked to leave the bus (a reset request); the host unplugs it and plugs it in again. Asked once per call.
  [[nodiscard]] virtual bool wants_to_leave() { return false; }
};

}  // namespace dts::emulator
