// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "core/clock.h"
#include "core/log.h"
#include "core/thread.h"
#include "device/usb/usb_bus.h"

namespace dts::device::usb {

/// The machine's USB through libusb-1.0: one context and one event thread ("usb-events") for all devices of the process. The first call
/// of `units` or `open` starts them; a process that never calls them has no such thread.
class LibusbBus final : public UsbBus {
 public:
  /// `policy`: scheduling of the event thread; its priority should be above that of the reading threads. `clock` must outlive the bus.
  LibusbBus(core::Clock& clock, core::ThreadPolicy policy, core::Log log);
  ~LibusbBus() override;  ///< All ports must be destroyed before.
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
