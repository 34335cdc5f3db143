// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "usb/emulator/emulated_device.h"
#include "usb/emulator/faults.h"
#include "usb/emulator/mcc_scan.h"

namespace dts::emulator {

enum class FsPlusKind : std::uint8_t { Usb1608, Usb1208, Usb1408, Usb201, Usb202, Usb204, Usb205 };

/// What differs between the family's members, written down apart from the driver's table: uldaq 1.2.1, Linux_Drivers by W. Jasper.
struct FsPlusParts {
  FsPlusKind kind = FsPlusKind::Usb1608;
  std::uint16_t product = 0;
  const char* name = "";
  unsigned bits = 16;
  std::int64_t clock_hz = 0;
  bool is_simultaneous = false;
  std::size_t fifo_codes = 0;
  std::size_t start_bytes = 10;
  bool has_range_list = true;
  std::size_t single_ended_record = 0;  ///< First calibration record of the single-ended inputs.
  bool has_records_per_range = false;
  bool has_port_direction = false;  ///< Request 0x00 turns all 8 lines at once: 0 output, else input; wIndex is the port.
};

/// The wire between the SYNC pins of two devices: one pulse per scan of the device that drives it.
class SyncLine {
 public:
  void drive(core::Rate rate, double speed, std::int64_t now_ns) noexcept {
    if (!is_cut_) pulses_.start(rate, speed, now_ns);
  }
  void release(std::int64_t now_ns) noexcept { pulses_.stop(now_ns); }
  /// The wire breaks: no more pulses arrive.
  void cut(std::int64_t now_ns) noexcept {
    is_cut_ = true;
    pulses_.stop(now_ns);
  }
  [[nodiscard]] const ScanClock& pulses() const noexcept { return pulses_; }

 private:
  ScanClock pulses_;
  bool is_cut_ = false;
};

/// A USB-1608FS-Plus or one of its relatives as MCC's drivers know it. The source gives 8 voltages.
class FsPlusEmulator final : public EmulatedDevice {
 public:
  static constexpr std::size_t kInputs = 8;

  FsPlusEmulator(FsPlusKind kind, const std::string& serial, Source source);
  FsPlusEmulator(const FsPlusEmulator&) = delete;
  FsPlusEmulator& operator=(const FsPlusEmulator&) = delete;

  int failing_starts = 0;       ///< So many starts overrun at once, as USB-204 does (Linux_Drivers issue #42).
  bool ignores_ranges = false;  ///< Range lists are acknowledged and forgotten.
  int forbidden_requests = 0;   ///< Writes to calibration, serial number or firmware that were asked for.

  /// The other end of the SYNC pin; outlives the device.
  void connect_sync(SyncLine& line) { sync_line_ = &line; }
  /// The trigger input does what an armed scan waits for.
  void fire_trigger(std::int64_t now_ns);
  [[nodiscard]] bool is_armed() const { return armed_.has_value(); }
  [[nodiscard]] bool is_scanning() const { return scan_.is_running(); }
  /// Level of a digital line; nullopt: it is an input.
  [[nodiscard]] std::optional<bool> digital_output(unsigned bit) const;
  /// Wires a digital output to an analogue input: 0 V or 5 V from the next scan after a change on.
  void loop_back(unsigned bit, std::size_t input) { loop_back_ = {bit, input}; }
  /// Factory calibration of an input at a range code.
  [[nodiscard]] std::pair<float, float> calibration(std::uint8_t range_code, std::size_t input) const;
  /// Bytes of the last start request.
  [[nodiscard]] const std::vector<std::uint8_t>& last_start() const { return last_start_; }

  [[nodiscard]] const Descriptors& descriptors() const override { return descriptors_; }
  void power_up(std::int64_t now_ns) override;
  [[nodiscard]] ControlReply control(const Setup& setup, std::span<const std::uint8_t> out_data, std::int64_t now_ns) override;
  void bulk_out(std::uint8_t, std::span<const std::uint8_t>, std::int64_t) override {}
  [[nodiscard]] std::optional<Packet> take_packet(std::uint8_t endpoint, std::int64_t now_ns) override;
  void clear_halt(std::uint8_t endpoint) override;
  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const override { return scan_.next_packet_ns(now_ns); }
  [[nodiscard]] bool wants_to_leave() override { return std::exchange(wants_to_leave_, false); }

 private:
  struct Start {
    std::uint32_t scans = 0;
    std::uint32_t period = 0;
    std::uint8_t mask = 0;
    bool is_immediate = false;
    bool drives_sync = false;
    bool has_trigger = false;
    bool counts = false;  ///< Debug data: an incrementing counter.
    bool stalls_on_overrun = true;
  };

  void write_calibration();
  [[nodiscard]] ControlReply read_request(const Setup& setup, std::int64_t now_ns);
  [[nodiscard]] ControlReply write_request(const Setup& setup, std::span<const std::uint8_t> data, std::int64_t now_ns);
  [[nodiscard]] ControlReply read_memory(const Setup& setup) const;
  [[nodiscard]] ControlReply read_input(const Setup& setup, std::int64_t now_ns);
  [[nodiscard]] ControlReply set_direction(const Setup& setup, std::int64_t now_ns);
  [[nodiscard]] ControlReply set_ranges(std::span<const std::uint8_t> data);
  [[nodiscard]] ControlReply start_request(std::span<const std::uint8_t> data, std::int64_t now_ns);
  [[nodiscard]] std::optional<Start> parse_start(std::span<const std::uint8_t> data) const;
  void stop(std::int64_t now_ns);
  void run(const Start& start, std::int64_t now_ns);
  void note_edge(std::int64_t now_ns);
  void mix_loop_back(double time_s, std::span<double> volts) const;
  [[nodiscard]] std::uint16_t code_of(std::size_t input, std::uint8_t range_code, double volts) const;

  FsPlusParts parts_;
  std::string serial_;
  Descriptors descriptors_;
  std::vector<std::uint8_t> memory_;  ///< Calibration.
  MccScan scan_;
  std::array<std::uint8_t, kInputs> ranges_{};
  std::uint8_t tristate_ = 0xFF;
  std::uint8_t latch_ = 0;
  std::optional<Start> armed_;
  SyncLine* sync_line_ = nullptr;
  bool drives_sync_ = false;
  ScanClock unconnected_;  ///< The SYNC pin with nothing on it.
  std::optional<std::pair<unsigned, std::size_t>> loop_back_;
  std::vector<std::pair<double, bool>> edges_;  ///< Of the looped line: device time, level.
  std::vector<std::uint8_t> last_start_;
  std::int64_t power_up_ns_ = 0;
  bool wants_to_leave_ = false;
};

}  // namespace dts::emulator
