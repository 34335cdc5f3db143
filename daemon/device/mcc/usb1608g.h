// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "device/device_entry.h"
#include "device/mcc/calibration.h"
#include "device/mcc/description.h"
#include "device/mcc/fpga.h"
#include "device/mcc/fs_plus_models.h"
#include "device/mcc/transfer_choice.h"
#include "device/usb/daq_driver.h"
#include "device/usb/daq_options.h"

namespace dts::device::mcc {

/// One product of the USB-1608G family. Sources: uldaq 1.2.1 (AiUsb1608g), Linux_Drivers by W. Jasper (usb-1608G.c).
struct Usb1608gModel {
  std::array<usb::UsbModel, 2> revisions;  ///< Hardware revisions; they need different FPGA images.
  double max_aggregate_hz = 0.0;
};
[[nodiscard]] std::span<const Usb1608gModel> usb_1608g_models() noexcept;

struct Usb1608gSettings {
  usb::DaqOptions options;
  Trigger trigger = Trigger::None;
  std::optional<unsigned> sync_output_bit;
  std::string fpga_path;  ///< Needed only if the device has no image: after each power-up.
};

inline constexpr std::size_t kScanListBytes = 16;
/// Returns the scan list: one byte per conversion, bits 0-2 input, 3-4 range, 5-6 single-ended 0-7 (1) or 8-15 (2), 7 last conversion.
[[nodiscard]] std::array<std::uint8_t, kScanListBytes> encode_scan_list(std::span<const std::size_t> inputs,
                                                                        std::span<const double> ranges_v);

struct GStartCommand {
  std::uint32_t period = 0;
  std::size_t packet_codes = 1;
  bool has_trigger = false;
};
/// Returns the 14 bytes that start an endless scan in burst mode.
[[nodiscard]] std::vector<std::uint8_t> encode_g_start(const GStartCommand& command);

/// Packets of whole scans: as many as 10 ms, the latency and the packet size allow; full packets if one fills in that time.
struct GPackets {
  std::size_t packet_codes = 1;
  TransferChoice transfers;
};
[[nodiscard]] GPackets choose_g_packets(const StreamLoad& load, const usb::ScanRequest& request);

/// The protocol of MCC's USB-1608G, 1608GX and 1608GX-2AO. The FPGA image is loaded from a file whenever the device reports that
/// it has none: after power-up and, on some hosts, after suspend. Scans always use burst mode: without it, public drivers
/// disagree about the meaning of the pacer's period.
class Usb1608g final : public usb::DaqDriver {
 public:
  Usb1608g(const Usb1608gModel& model, Usb1608gSettings settings);

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] std::span<const usb::UsbModel> models() const noexcept override { return model_.revisions; }
  [[nodiscard]] std::vector<usb::UsbModel> relatives() const override { return all_models(); }
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override;
  [[nodiscard]] double volts(std::size_t channel, std::uint16_t code) const noexcept override { return lines_[channel].at(code); }
  [[nodiscard]] bool is_rail(std::size_t channel, std::uint16_t code) const noexcept override;

  [[nodiscard]] core::Status connect(usb::UsbPort& port, std::vector<DeviceCheck>& checks) override;
  [[nodiscard]] core::Result<usb::ScanPlan> configure(usb::UsbPort& port, const usb::ScanRequest& request) override;
  [[nodiscard]] core::Result<std::vector<double>> read_once(usb::UsbPort& port) override;
  [[nodiscard]] core::Status begin(usb::UsbPort& port) override;
  [[nodiscard]] core::Status make_ready(usb::UsbPort& port) override;
  [[nodiscard]] core::Status end(usb::UsbPort& port) noexcept override;
  [[nodiscard]] core::Result<usb::ScanHealth> health(usb::UsbPort& port) override;
  [[nodiscard]] bool waits_for_trigger() const noexcept override { return command_.has_trigger; }
  [[nodiscard]] core::Status set_sync_output(usb::UsbPort& port, bool is_high) override;
  [[nodiscard]] usb::Unpacked unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept override;

 private:
  [[nodiscard]] core::Result<bool> ensure_fpga(usb::UsbPort& port);
  [[nodiscard]] core::Status read_calibration(usb::UsbPort& port);
  [[nodiscard]] core::Status make_quiet(usb::UsbPort& port);
  [[nodiscard]] core::Status set_trigger(usb::UsbPort& port);
  [[nodiscard]] core::Status set_scan_list(usb::UsbPort& port);
  [[nodiscard]] core::Result<std::uint16_t> convert(usb::UsbPort& port, std::size_t input, double range_v);

  const Usb1608gModel& model_;
  Usb1608gSettings settings_;
  DeviceDescription description_;
  std::vector<VoltageLine> lines_;  ///< By position in the scan.
  GStartCommand command_;
};

[[nodiscard]] std::vector<UriOption> usb_1608g_options();
/// Creates the device; no unit needs to be present. Fails with Unsupported if there is no USB.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_usb_1608g(const Usb1608gModel& model, const DeviceUri& uri,
                                                                     const DeviceContext& context);

}  // namespace dts::device::mcc
