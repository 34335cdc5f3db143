// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/device_checks.h"
#include "device/usb/daq_driver.h"
#include "unit/device/usb/toy_device.h"

namespace dts::device::usb::test {

inline constexpr std::array kToyModels = {UsbModel{kToyVendor, kToyProduct, "Toy", "toy:daq"}};
inline constexpr std::int64_t kToyClockHz = 40'000'000;

struct ToyDriverOptions {
  std::size_t channels = 4;
  bool has_single_readings = true;
  bool waits_for_trigger = false;
  std::size_t buffer_chunks = 1024;
};

/// The other side of ToyDevice.
class ToyDriver final : public DaqDriver {
 public:
  explicit ToyDriver(ToyDriverOptions options) : options_(options) {
    description_ = {.uri = "toy:daq", .model = "Toy", .serial = "", .channels = {}, .minimum_rate_hz = 1, .maximum_rate_hz = 20'000};
    for (std::size_t i = 0; i < options.channels; ++i) {
      description_.channels.push_back({.name = "ch" + std::to_string(i), .unit = "V", .maximum = 6.5535, .resolution = kToyVoltsPerCode});
    }
  }

  [[nodiscard]] const DeviceDescription& describe() const noexcept override { return description_; }
  [[nodiscard]] std::span<const UsbModel> models() const noexcept override { return kToyModels; }
  [[nodiscard]] core::Result<core::Rate> exact_rate(core::Rate wanted) const override {
    if (auto checked = check_rate(description_, wanted); !checked) return checked;
    return core::Rate::create(kToyClockHz, std::llround(static_cast<double>(kToyClockHz) / wanted.hz()));
  }
  [[nodiscard]] double volts(std::size_t, std::uint16_t code) const noexcept override { return code * kToyVoltsPerCode; }
  [[nodiscard]] bool is_rail(std::size_t, std::uint16_t code) const noexcept override { return code == kToyRailCode; }
  [[nodiscard]] bool waits_for_trigger() const noexcept override { return options_.waits_for_trigger && !is_restart_; }

  [[nodiscard]] core::Status connect(UsbPort& port, std::vector<DeviceCheck>& checks) override {
    if (auto stopped = tell(port, {kToyStop}, {}); !stopped) return stopped;
    std::array<std::uint8_t, 3> identity{};
    if (auto asked = ask(port, {kToyIdentity}, identity); !asked) return asked;
    identity_ = identity[2] == 0 ? UnitIdentity{} : UnitIdentity{"N" + std::to_string(identity[2]), "7.7"};
    if (identity[0] != 0xCA || identity[1] != 0x1B) return core::fail(core::ErrorCode::DataDamaged, "this is no toy");
    checks.push_back({"identity", DeviceCheck::Outcome::Passed, "a toy"});
    return {};
  }
  [[nodiscard]] UnitIdentity identity() const override { return identity_; }
  [[nodiscard]] core::Result<ScanPlan> configure(UsbPort& port, const ScanRequest& request) override {
    carry_.reset();
    is_gap_count_next_ = false;
    is_restart_ = request.is_restart;
    const bool is_large = request.must_use_large_packets || request.rate.hz() > 1000.0 || 2 * options_.channels > kToyPacketBytes;
    std::array<std::uint8_t, 10> data{};
    const std::array<std::int64_t, 2> terms = {request.rate.numerator(), request.rate.denominator()};
    for (std::size_t i = 0; i < 8; ++i) data[i] = static_cast<std::uint8_t>(terms[i / 4] >> (8 * (i % 4)));
    data[8] = static_cast<std::uint8_t>(options_.channels);
    data[9] = static_cast<std::uint8_t>((is_large ? 1U : 0U) | (waits_for_trigger() ? 2U : 0U));
    if (auto told = tell(port, {kToyConfigure}, data); !told) return tl::make_unexpected(told.error());
    if (auto cleared = port.clear_halt(kToyEndpoint); !cleared) return tl::make_unexpected(to_error(cleared.error(), "clear halt"));
    const std::uint64_t packet_scans = is_large ? std::max<std::uint64_t>(kToyPacketBytes / 2 / options_.channels, 1) : 1;
    const double packets = is_large ? request.rate.hz() * 0.01 * static_cast<double>(options_.channels) / 32.0 : 1.0;
    const std::size_t bytes = kToyPacketBytes * static_cast<std::size_t>(std::max(1.0, std::ceil(packets)));
    return ScanPlan{{kToyEndpoint, bytes, 8, options_.buffer_chunks}, request.rate.time_ns({packet_scans}), is_large ? "large" : "small"};
  }
  [[nodiscard]] core::Result<std::vector<double>> read_once(UsbPort& port) override {
    if (!options_.has_single_readings) return core::fail(core::ErrorCode::Unsupported, "no single readings");
    std::vector<double> volts;
    for (std::uint16_t channel = 0; channel < options_.channels; ++channel) {
      std::array<std::uint8_t, 2> code{};
      if (auto asked = ask(port, {kToySingle, channel}, code); !asked) return tl::make_unexpected(asked.error());
      volts.push_back((code[0] | code[1] << 8U) * kToyVoltsPerCode);
    }
    return volts;
  }
  [[nodiscard]] core::Status begin(UsbPort& port) override { return tell(port, {kToyBegin}, {}); }
  [[nodiscard]] core::Status end(UsbPort& port) noexcept override { return tell(port, {kToyStop}, {}); }
  [[nodiscard]] core::Result<ScanHealth> health(UsbPort& port) override {
    std::array<std::uint8_t, 1> status{};
    if (auto asked = ask(port, {kToyStatus}, status); !asked) return tl::make_unexpected(asked.error());
    return ScanHealth{(status[0] & 1U) != 0, (status[0] & 2U) != 0};
  }
  [[nodiscard]] core::Status set_sync_output(UsbPort& port, bool is_high) override {
    return tell(port, {kToySync, static_cast<std::uint16_t>(is_high ? 1 : 0)}, {});
  }

  [[nodiscard]] Unpacked unpack(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> codes) noexcept override {
    Unpacked result;
    while (result.bytes < bytes.size() && result.codes < codes.size()) {
      const std::uint8_t byte = bytes[result.bytes++];
      if (!carry_) {
        carry_ = byte;
        continue;
      }
      const auto word = static_cast<std::uint16_t>(*carry_ | byte << 8U);
      carry_.reset();
      if (is_gap_count_next_) {
        is_gap_count_next_ = false;
        result.fault = core::GapReason::Overrun;
        result.goes_on = true;
        result.discarded_scans = word;
        return result;
      }
      is_gap_count_next_ = word == kToyGapCode;
      if (!is_gap_count_next_) codes[result.codes++] = word;
    }
    return result;
  }

 private:
  core::Status tell(UsbPort& port, ControlRequest request, std::span<const std::uint8_t> data) {
    const UsbResult sent = port.control_out(request, data, kControlTimeoutMs);
    if (sent) return {};
    return tl::make_unexpected(to_error(sent.error(), "request " + std::to_string(request.request)));
  }
  core::Status ask(UsbPort& port, ControlRequest request, std::span<std::uint8_t> data) {
    const UsbResult received = port.control_in(request, data, kControlTimeoutMs);
    if (!received) return tl::make_unexpected(to_error(received.error(), "request " + std::to_string(request.request)));
    if (*received == data.size()) return {};
    return core::fail(core::ErrorCode::DataDamaged, "request " + std::to_string(request.request) + ": short answer");
  }

  ToyDriverOptions options_;
  DeviceDescription description_;
  UnitIdentity identity_;
  std::optional<std::uint8_t> carry_;  ///< Low byte of a code whose high byte is in the next packet.
  bool is_gap_count_next_ = false;
  bool is_restart_ = false;
};

}  // namespace dts::device::usb::test
