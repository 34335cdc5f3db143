// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "device/device_entry.h"
#include "device/labjack/u6_calibration.h"
#include "device/labjack/u6_stream.h"
#include "device/usb/daq_driver.h"
#include "device/usb/daq_options.h"

namespace dts::device::labjack {

/// Channel number of FIO0..7 and EIO0..7 as one word, sampled like an input.
inline constexpr std::size_t kDigitalWord = 193;

/// LabJack U6 and U6-Pro over their documented low-level protocol, at resolution index 1. All data use three bulk endpoints. Single
/// readings and outputs need commands that are not implemented, so `read_once` and the sync output are Unsupported. Instead of the
/// start check, use counter, checksums and the ground channel as a marker.
class U6 final : public usb::DaqDriver {
 public:
  /// `options`: a result of `read_u6_options`.
  explicit U6(usb::DaqOptions options);

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] std::span<const usb::UsbModel> models() const noexcept override;
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override;
  /// Returns volts; for the digital word, which is no voltage, the code.
  [[nodiscard]] double volts(std::size_t channel, std::uint16_t code) const noexcept override;
  [[nodiscard]] bool is_rail(std::size_t channel, std::uint16_t code) const noexcept override;

  [[nodiscard]] core::Status connect(usb::UsbPort& port, std::vector<DeviceCheck>& checks) override;
  [[nodiscard]] usb::UnitIdentity identity() const override { return identity_; }
  [[nodiscard]] core::Result<usb::ScanPlan> configure(usb::UsbPort& port, const usb::ScanRequest& request) override;
  [[nodiscard]] core::Result<std::vector<double>> read_once(usb::UsbPort& port) override;
  [[nodiscard]] core::Status begin(usb::UsbPort& port) override;
  [[nodiscard]] core::Status end(usb::UsbPort& port) noexcept override;
  [[nodiscard]] core::Result<usb::ScanHealth> health(usb::UsbPort& port) override;
  [[nodiscard]] usb::Unpacked unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept override {
    return parser_.unpack(bytes, codes);
  }

 private:
  [[nodiscard]] core::Status end_earlier_stream(usb::UsbPort& port, std::vector<DeviceCheck>& checks);
  [[nodiscard]] core::Status identify(usb::UsbPort& port, std::vector<DeviceCheck>& checks);
  [[nodiscard]] core::Status read_constants(usb::UsbPort& port, std::vector<DeviceCheck>& checks);

  usb::DaqOptions options_;
  std::vector<std::size_t> gains_;  ///< Gain index at each position; `kRangesV.size()`: the digital word.
  DeviceDescription description_;
  usb::UnitIdentity identity_;
  Calibration calibration_ = Calibration::nominal();
  StreamParser parser_;
};

/// Reads serial, channels, range_v, marker..., digital. The digital word is after the inputs and before the marker.
[[nodiscard]] core::Result<usb::DaqOptions> read_u6_options(const DeviceUri& uri);

/// Creates "labjack:u6", for the registry.
[[nodiscard]] core::Result<std::unique_ptr<Device>> create_u6(const DeviceUri& uri, const DeviceContext& context);
[[nodiscard]] std::vector<usb::UsbModel> u6_models();

}  // namespace dts::device::labjack
