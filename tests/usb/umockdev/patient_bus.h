// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "device/usb/daq_driver.h"
#include "device/usb/usb_bus.h"

namespace dts::emulator {

/// A bus whose requests may take as long as a busy machine needs. libusb times them by the machine's time, and the drivers ask for 100 ms.
class PatientBus final : public device::usb::UsbBus {
 public:
  explicit PatientBus(device::usb::UsbBus& bus) : bus_(bus) {}

  /// false: requests time out when their driver says so.
  std::atomic<bool> is_patient = true;

  [[nodiscard]] core::Result<std::vector<device::usb::UsbUnit>> units(std::span<const device::usb::UsbModel> models) override {
    return bus_.units(models);
  }
  [[nodiscard]] core::Result<std::unique_ptr<device::usb::UsbPort>> open(const device::usb::UsbUnit& unit) override {
    auto opened = bus_.open(unit);
    if (!opened) return opened;
    return std::make_unique<Port>(*this, std::move(*opened));
  }
  [[nodiscard]] std::uint64_t arrivals() const noexcept override { return bus_.arrivals(); }

 private:
  class Port final : public device::usb::UsbPort {
   public:
    Port(const PatientBus& bus, std::unique_ptr<device::usb::UsbPort> port) : bus_(bus), port_(std::move(port)) {}

    [[nodiscard]] const device::usb::UsbUnit& unit() const noexcept override { return port_->unit(); }
    [[nodiscard]] core::Result<std::size_t> max_packet_bytes(std::uint8_t endpoint) const override {
      return port_->max_packet_bytes(endpoint);
    }
    [[nodiscard]] bool is_high_speed() const noexcept override { return port_->is_high_speed(); }
    [[nodiscard]] device::usb::UsbResult control_in(const device::usb::ControlRequest& request, std::span<std::uint8_t> data,
                                                    int timeout_ms) override {
      return port_->control_in(request, data, patient(timeout_ms));
    }
    [[nodiscard]] device::usb::UsbResult control_out(const device::usb::ControlRequest& request, std::span<const std::uint8_t> data,
                                                     int timeout_ms) override {
      return port_->control_out(request, data, patient(timeout_ms));
    }
    [[nodiscard]] device::usb::UsbResult bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> data, int timeout_ms) override {
      return port_->bulk_in(endpoint, data, patient(timeout_ms));
    }
    [[nodiscard]] device::usb::UsbResult bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data, int timeout_ms) override {
      return port_->bulk_out(endpoint, data, patient(timeout_ms));
    }
    [[nodiscard]] device::usb::UsbResult clear_halt(std::uint8_t endpoint) override { return port_->clear_halt(endpoint); }
    [[nodiscard]] core::Status prepare_transfers(std::uint8_t endpoint, std::size_t count, std::size_t bytes,
                                                 device::usb::TransferListener& listener) override {
      return port_->prepare_transfers(endpoint, count, bytes, listener);
    }
    [[nodiscard]] device::usb::UsbStatus submit(std::size_t index) noexcept override { return port_->submit(index); }
    void cancel(std::size_t index) noexcept override { port_->cancel(index); }
    void release_transfers() noexcept override { port_->release_transfers(); }
    void wait(std::int64_t deadline_ns) noexcept override { port_->wait(deadline_ns); }

   private:
    static constexpr int kPatienceMs = 60'000;
    /// A shorter wait than a request's is for data that are probably not there: it ends by its time.
    [[nodiscard]] int patient(int timeout_ms) const noexcept {
      return bus_.is_patient && timeout_ms >= device::usb::kControlTimeoutMs ? kPatienceMs : timeout_ms;
    }

    const PatientBus& bus_;
    std::unique_ptr<device::usb::UsbPort> port_;
  };

  device::usb::UsbBus& bus_;
};

}  // namespace dts::emulator
