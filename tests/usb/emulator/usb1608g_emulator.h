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

/// A USB-1608G, 1608GX or 1608GX-2AO as uldaq 1.2.1 and Linux_Drivers by W. Jasper know it: useless after power-up until an FPGA
/// image of the right length was loaded. The source gives 16 voltages.
class Usb1608gEmulator final : public EmulatedDevice {
 public:
  static constexpr std::size_t kInputs = 16;
  static constexpr std::size_t kFifoCodes = 4'096;
  static constexpr double kSkewS = 2e-6;  ///< Between two conversions of a burst.

  /// `product`: 0x0110 to 0x0112 (hardware revision 1) or 0x0134 to 0x0136 (2). Not high speed: on a full speed hub.
  Usb1608gEmulator(std::uint16_t product, const std::string& serial, Source source, bool is_high_speed = true);
  Usb1608gEmulator(const Usb1608gEmulator&) = delete;
  Usb1608gEmulator& operator=(const Usb1608gEmulator&) = delete;

  int rotated_starts = 0;                ///< The first sample of so many scans is missing (uldaq issue #50).
  bool non_burst_divides_rate = true;    ///< Without burst the period is that of a conversion, not of a scan: sources disagree.
  bool takes_only_15_bytes = false;      ///< A firmware that refuses the start of 14 bytes.
  bool ignores_scan_list = false;        ///< Scan lists are acknowledged and forgotten.
  bool leaves_readings_in_fifo = false;  ///< Single conversions are also put before the next scan.
  int forbidden_requests = 0;            ///< Writes to memory or serial number that were asked for.

  /// The host's suspend: power stays, the address stays, the FPGA forgets.
  void suspend(std::int64_t now_ns);
  void fire_trigger(std::int64_t now_ns);
  [[nodiscard]] bool is_armed() const { return armed_.has_value(); }
  [[nodiscard]] int images_loaded() const { return images_loaded_; }
  [[nodiscard]] std::uint8_t trigger_config() const { return trigger_config_; }
  [[nodiscard]] const std::vector<std::uint8_t>& last_start() const { return last_start_; }
  [[nodiscard]] static std::size_t image_bytes(std::uint16_t product) { return product < 0x0134 ? 73'829 : 73'722; }
  /// Factory calibration of a range code, 0 to 3.
  [[nodiscard]] static std::pair<float, float> calibration(std::size_t range_code);

  [[nodiscard]] const Descriptors& descriptors() const override { return descriptors_; }
  void power_up(std::int64_t now_ns) override;
  [[nodiscard]] ControlReply control(const Setup& setup, std::span<const std::uint8_t> out_data, std::int64_t now_ns) override;
  void bulk_out(std::uint8_t, std::span<const std::uint8_t>, std::int64_t) override {}
  [[nodiscard]] std::optional<Packet> take_packet(std::uint8_t endpoint, std::int64_t now_ns) override;
  void clear_halt(std::uint8_t endpoint) override;
  [[nodiscard]] std::int64_t next_packet_ns(std::int64_t now_ns) const override { return scan_.next_packet_ns(now_ns); }
  [[nodiscard]] bool wants_to_leave() override { return std::exchange(wants_to_leave_, false); }

 private:
  /// One element of the scan list.
  struct Element {
    std::size_t input = 0;
    std::size_t range_code = 0;
  };
  struct Start {
    std::uint32_t scans = 0;
    std::uint32_t period = 0;
    std::size_t packet_codes = 1;
    bool is_burst = false;
    bool has_trigger = false;
  };

  [[nodiscard]] ControlReply read_request(const Setup& setup, std::int64_t now_ns);
  [[nodiscard]] ControlReply write_request(const Setup& setup, std::span<const std::uint8_t> data, std::int64_t now_ns);
  [[nodiscard]] ControlReply read_memory(std::size_t length);
  [[nodiscard]] ControlReply read_input(std::size_t input, std::int64_t now_ns);
  [[nodiscard]] ControlReply start_request(std::span<const std::uint8_t> data, std::int64_t now_ns);
  [[nodiscard]] ControlReply fpga_command(std::span<const std::uint8_t> data);
  [[nodiscard]] ControlReply fpga_data(std::size_t count);
  [[nodiscard]] ControlReply set_list(std::span<const std::uint8_t> data);
  [[nodiscard]] std::vector<Element> list() const;
  void run(const Start& start, std::int64_t now_ns);
  void stop(std::int64_t now_ns);

  std::uint16_t product_;
  std::string serial_;
  Descriptors descriptors_;
  std::vector<std::uint8_t> memory_;
  std::uint16_t address_ = 0;
  MccScan scan_;
  std::array<std::uint8_t, 16> list_{};
  std::uint8_t trigger_config_ = 0;
  std::uint8_t tristate_ = 0xFF;
  std::uint8_t latch_ = 0;
  std::optional<Start> armed_;
  ScanClock unconnected_;  ///< The clock input with nothing on it.
  std::vector<std::uint8_t> last_start_;
  std::size_t image_received_ = 0;
  int images_loaded_ = 0;
  bool is_configuring_ = false;
  bool is_configured_ = false;
  bool is_next_reading_garbage_ = false;
  std::int64_t power_up_ns_ = 0;
  bool wants_to_leave_ = false;
};

}  // namespace dts::emulator
