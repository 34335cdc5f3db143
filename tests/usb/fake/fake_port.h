// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "device/usb/usb_port.h"
#include "usb/emulator/emulated_device.h"
#include "usb/emulator/urb_queue.h"

namespace dts::emulator {

class FakeBus;

/// A device in a socket of the fake bus, until it is pulled out.
struct Plug {
  EmulatedDevice& device;
  device::usb::UsbUnit unit;
  bool is_gone = false;
  bool is_claimed = false;
};

/// One opened device of a FakeBus, which drives it: packets fill transfers, finished ones are told to the listener when the
/// host would notice.
class FakePort final : public device::usb::UsbPort {
 public:
  FakePort(FakeBus& bus, std::shared_ptr<Plug> plug);
  ~FakePort() override;
  FakePort(const FakePort&) = delete;
  FakePort& operator=(const FakePort&) = delete;

  [[nodiscard]] const device::usb::UsbUnit& unit() const noexcept override { return plug_->unit; }
  [[nodiscard]] core::Result<std::size_t> max_packet_bytes(std::uint8_t endpoint) const override;
  [[nodiscard]] bool is_high_speed() const noexcept override { return plug_->device.descriptors().is_high_speed; }
  [[nodiscard]] device::usb::UsbResult control_in(const device::usb::ControlRequest& request, std::span<std::uint8_t> data,
                                                  int timeout_ms) override;
  [[nodiscard]] device::usb::UsbResult control_out(const device::usb::ControlRequest& request, std::span<const std::uint8_t> data,
                                                   int timeout_ms) override;
  [[nodiscard]] device::usb::UsbResult bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> data, int timeout_ms) override;
  [[nodiscard]] device::usb::UsbResult bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data, int timeout_ms) override;
  [[nodiscard]] device::usb::UsbResult clear_halt(std::uint8_t endpoint) override;
  [[nodiscard]] core::Status prepare_transfers(std::uint8_t endpoint, std::size_t count, std::size_t bytes,
                                               device::usb::TransferListener& listener) override;
  [[nodiscard]] device::usb::UsbStatus submit(std::size_t index) noexcept override;
  void cancel(std::size_t index) noexcept override;
  void release_transfers() noexcept override;
  void wait(std::int64_t deadline_ns) noexcept override;

  // What the bus needs.
  [[nodiscard]] const Plug& plug() const noexcept { return *plug_; }
  [[nodiscard]] int in_flight() const noexcept { return static_cast<int>(in_flight_.size()); }
  /// When something may happen here next.
  [[nodiscard]] std::int64_t next_event_ns(std::int64_t now_ns) const;
  /// Lets the device fill transfers and tells of those that are due; true when anything moved.
  bool advance(std::int64_t now_ns);
  void lose();

 private:
  struct Completion {
    FinishedUrb urb;
    std::int64_t due_ns = 0;
  };
  [[nodiscard]] std::optional<ControlReply> control(const Setup& setup, std::span<const std::uint8_t> out_data, int timeout_ms,
                                                    device::usb::UsbStatus& status);
  [[nodiscard]] UrbQueue* queue(std::uint8_t endpoint);
  void note(std::vector<FinishedUrb> finished);
  [[nodiscard]] bool deliver(std::int64_t now_ns);

  FakeBus& bus_;
  std::shared_ptr<Plug> plug_;
  std::map<std::uint8_t, UrbQueue> queues_;
  device::usb::TransferListener* listener_ = nullptr;
  std::uint8_t stream_endpoint_ = 0;
  std::size_t transfer_count_ = 0;
  std::size_t transfer_bytes_ = 0;
  std::set<std::uint64_t> in_flight_;
  std::deque<Completion> completions_;      ///< Ended on the bus, not noticed by the host yet.
  std::optional<FinishedUrb> sync_result_;  ///< Of the bulk_in under way.
  bool has_news_ = false;                   ///< A transfer has finished since the last wait.
};

}  // namespace dts::emulator
