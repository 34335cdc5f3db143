// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/clock.h"
#include "core/log.h"
#include "core/thread.h"
#include "device/usb/usb_bus.h"

namespace dts::device::usb {

/// The machine's USB through libusb-1.0: one context and one event thread ("usb-events") for all devices of the process,
/// started when it is first asked for anything. A process without USB devices pays nothing.
class LibusbBus final : public UsbBus {
 public:
  /// `policy`: how the event thread is scheduled; it should go before the threads that read. `clock` outlives the bus.
  LibusbBus(core::Clock& clock, core::ThreadPolicy policy, core::Log log);
  ~LibusbBus() override;  ///< All ports must be gone.
  LibusbBus(const LibusbBus&) = delete;
  LibusbBus& operator=(const LibusbBus&) = delete;

  [[nodiscard]] core::Result<std::vector<UsbUnit>> units(std::span<const UsbModel> models) override;
  [[nodiscard]] core::Result<std::unique_ptr<UsbPort>> open(const UsbUnit& unit) override;
  [[nodiscard]] std::uint64_t arrivals() const noexcept override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace dts::device::usb
