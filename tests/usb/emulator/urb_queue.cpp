// SPDX-License-Identifier: Apache-2.0
#include "usb/emulator/urb_queue.h"

#include <algorithm>
#include <utility>

namespace dts::emulator {

using device::usb::UsbStatus;

void UrbQueue::submit(std::uint64_t id, std::size_t capacity) { urbs_.push_back({id, capacity, {}}); }

std::optional<FinishedUrb> UrbQueue::cancel(std::uint64_t id) {
  const auto found = std::find_if(urbs_.begin(), urbs_.end(), [id](const Urb& urb) { return urb.id == id; });
  if (found == urbs_.end()) return std::nullopt;
  FinishedUrb finished{id, UsbStatus::Cancelled, std::move(found->bytes)};
  urbs_.erase(found);
  return finished;
}

std::vector<FinishedUrb> UrbQueue::end_all(UsbStatus status) {
  std::vector<FinishedUrb> finished;
  for (Urb& urb : urbs_) finished.push_back({urb.id, status, std::move(urb.bytes)});
  urbs_.clear();
  return finished;
}

std::vector<FinishedUrb> UrbQueue::advance(EmulatedDevice& device, std::int64_t now_ns) {
  std::vector<FinishedUrb> finished;
  while (!urbs_.empty() && !is_halted_) {
    const std::optional<Packet> packet = device.take_packet(endpoint_, now_ns);
    if (!packet) break;
    is_halted_ = packet->is_stall;
    if (is_halted_) break;
    if (const auto status = take(packet->bytes)) {
      finished.push_back({urbs_.front().id, *status, std::move(urbs_.front().bytes)});
      urbs_.pop_front();
    }
  }
  if (!is_halted_) return finished;
  for (FinishedUrb& urb : end_all(UsbStatus::Stall)) finished.push_back(std::move(urb));
  return finished;
}

std::optional<UsbStatus> UrbQueue::take(const std::vector<std::uint8_t>& packet) {
  Urb& urb = urbs_.front();
  const std::size_t room = std::min(urb.capacity - urb.bytes.size(), packet_bytes_);
  const std::size_t taken = std::min(room, packet.size());
  urb.bytes.reserve(urb.capacity);
  urb.bytes.insert(urb.bytes.end(), packet.begin(), packet.begin() + static_cast<std::ptrdiff_t>(taken));
  if (packet.size() > room) return UsbStatus::Overflow;
  const bool is_short = packet.size() < packet_bytes_;
  if (is_short || urb.bytes.size() == urb.capacity) return UsbStatus::Completed;
  return std::nullopt;
}

}  // namespace dts::emulator
