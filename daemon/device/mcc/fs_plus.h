// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "device/device_entry.h"
#include "device/mcc/calibration.h"
#include "device/mcc/description.h"
#include "device/mcc/fs_plus_models.h"
#include "device/usb/daq_driver.h"
#include "device/usb/daq_options.h"

namespace dts::device::mcc {

/// The user's settings for a unit of the family.
struct FsPlusSettings {
  usb::DaqOptions options;
  Trigger trigger = Trigger::None;
  SyncPin sync = SyncPin::Unused;
  bool is_partner_triggered = false;        ///< The other unit, which drives SYNC, waits for a trigger first.
  std::optional<unsigned> sync_output_bit;  ///< Digital line that signals a session to other instruments.
};

/// The protocol of MCC's FS-Plus family: USB-1608FS-Plus, 1208FS-Plus, 1408FS-Plus, USB-201, 202, 204 and 205. The rows of
/// `fs_plus_models` contain their differences. This code has no request that writes calibration, serial number or firmware.
///
///     connect    stop, calibration
///     configure  stop, clear FIFO, clear errors, clear halt, drain, ranges written and read back
///     make_ready clear FIFO, clear halt
///     begin      start
///     end        stop, read the status until the scan has stopped
class FsPlus final : public usb::DaqDriver {
 public:
  FsPlus(const FsPlusModel& model, FsPlusSettings settings);

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] std::span<const usb::UsbModel> models() const noexcept override { return {&model_.usb, 1}; }
  [[nodiscard]] std::vector<usb::UsbModel> relatives() const override { return all_models(); }
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override;
  [[nodiscard]] double volts(std::size_t channel, std::uint16_t code) const noexcept override { return lines_[channel].at(code); }
  [[nodiscard]] bool is_rail(std::size_t, std::uint16_t code) const noexcept override { return code == 0 || code == model_.largest_code(); }

  [[nodiscard]] core::Status connect(usb::UsbPort& port, std::vector<DeviceCheck>& checks) override;
  [[nodiscard]] core::Result<usb::ScanPlan> configure(usb::UsbPort& port, const usb::ScanRequest& request) override;
  [[nodiscard]] core::Result<std::vector<double>> read_once(usb::UsbPort& port) override;
  [[nodiscard]] core::Status begin(usb::UsbPort& port) override;
  [[nodiscard]] core::Status make_ready(usb::UsbPort& port) override;
  [[nodiscard]] core::Status end(usb::UsbPort& port) noexcept override;
  [[nodiscard]] core::Result<usb::ScanHealth> health(usb::UsbPort& port) override;
  [[nodiscard]] bool waits_for_trigger() const noexcept override;
  [[nodiscard]] bool may_start_late() const noexcept override { return may_start_late_; }
  [[nodiscard]] core::Status set_sync_output(usb::UsbPort& port, bool is_high) override;
  [[nodiscard]] usb::Unpacked unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept override;

 private:
  [[nodiscard]] core::Status read_calibration(usb::UsbPort& port);
  [[nodiscard]] core::Status make_quiet(usb::UsbPort& port);
  [[nodiscard]] core::Status set_ranges(usb::UsbPort& port);
  [[nodiscard]] core::Status start_in_vain(usb::UsbPort& port);
  [[nodiscard]] core::Status send_start(usb::UsbPort& port);

  const FsPlusModel& model_;
  FsPlusSettings settings_;
  DeviceDescription description_;
  std::vector<VoltageLine> lines_;  ///< By position in the scan.
  StartCommand command_;
  bool is_first_scan_ = true;  ///< No scan was configured since `connect`.
  bool may_start_late_ = false;
};

/// Returns the limits of the model's inputs.
[[nodiscard]] usb::DaqLimits limits_of(const FsPlusModel& model);
/// Returns the options of "mcc:1608fs-plus?".
[[nodiscard]] std::vector<UriOption> fs_plus_options(const FsPlusModel& model);
/// Creates the device; no unit needs to be present. Fails with Unsupported if there is no USB.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_fs_plus(const FsPlusModel& model, const DeviceUri& uri,
                                                                   const DeviceContext& context);

}  // namespace dts::device::mcc
