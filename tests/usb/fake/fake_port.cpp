// SPDX-License-Identifier: Apache-2.0
#include "usb/fake/fake_port.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>

#include "usb/fake/fake_bus.h"

namespace dts::emulator {
namespace {

using device::usb::UsbResult;
using device::usb::UsbStatus;

constexpr std::uint64_t kSyncId = std::uint64_t{1} << 40U;  // beside the indices of prepared transfers
constexpr std::int64_t kFrameNs = 125'000;                  // a device that cannot say when is asked again after this
constexpr std::uint8_t kVendorOut = 0x40;
constexpr std::uint8_t kVendorIn = 0xC0;
constexpr std::uint8_t kEndpointDescriptorType = 5;

UsbResult failed(UsbStatus status) { return tl::make_unexpected(status); }

std::string hex(unsigned number) {
  char text[8];
  std::snprintf(text, sizeof text, "%02x", number);
  return text;
}

/// The bytes of a short request, the size of a long one.
std::string hex(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > 32) return std::to_string(bytes.size()) + " bytes";
  std::string text;
  for (const std::uint8_t byte : bytes) text += hex(unsigned{byte});
  return text.empty() ? "-" : text;
}

std::string words(const char* direction, const device::usb::ControlRequest& request) {
  return std::string(direction) + " " + hex(request.request) + " " + hex(request.value) + " " + hex(request.index) + " ";
}

std::string limit(int timeout_ms) { return " " + std::to_string(timeout_ms) + " ms"; }

/// wMaxPacketSize of an endpoint in a configuration descriptor; 0: not there.
std::size_t packet_bytes(const std::vector<std::uint8_t>& configuration, std::uint8_t endpoint) {
  std::size_t at = 0;
  while (at + 1 < configuration.size() && configuration[at] >= 2) {
    const std::size_t length = configuration[at];
    if (configuration[at + 1] == kEndpointDescriptorType && at + 5 < configuration.size() && configuration[at + 2] == endpoint) {
      return (configuration[at + 4] | static_cast<std::size_t>(configuration[at + 5]) << 8U) & 0x7FFU;
    }
    at += length;
  }
  return 0;
}

}  // namespace

FakePort::FakePort(FakeBus& bus, std::shared_ptr<Plug> plug) : bus_(bus), plug_(std::move(plug)) {
  plug_->is_claimed = true;
  bus_.ports_.push_back(this);
}

FakePort::~FakePort() {
  plug_->is_claimed = false;
  std::erase(bus_.ports_, this);
  bus_.abandoned_transfers_ += in_flight();
}

core::Result<std::size_t> FakePort::max_packet_bytes(std::uint8_t endpoint) const {
  const std::size_t bytes = packet_bytes(plug_->device.descriptors().configuration, endpoint);
  if (bytes > 0) return bytes;
  return core::fail(core::ErrorCode::NotFound, "endpoint " + std::to_string(endpoint) + " does not exist");
}

UrbQueue* FakePort::queue(std::uint8_t endpoint) {
  const auto bytes = max_packet_bytes(endpoint);
  if (!bytes) return nullptr;
  return &queues_.try_emplace(endpoint, endpoint, *bytes).first->second;
}

std::optional<ControlReply> FakePort::control(const Setup& setup, std::span<const std::uint8_t> out_data, int timeout_ms,
                                              UsbStatus& status) {
  bus_.spend(bus_.request_ns);
  status = UsbStatus::NoDevice;
  if (plug_->is_gone) return std::nullopt;
  ControlReply reply = plug_->device.control(setup, out_data, bus_.now_ns());
  if (reply.kind == ReplyKind::Silence) {
    bus_.spend(timeout_ms * core::kNanosecondsPerMillisecond);
    status = plug_->is_gone ? UsbStatus::NoDevice : UsbStatus::TimedOut;
    return std::nullopt;
  }
  bus_.settle();
  status = UsbStatus::Stall;
  if (reply.kind == ReplyKind::Stall) return std::nullopt;
  status = UsbStatus::Completed;
  return reply;
}

UsbResult FakePort::control_in(const device::usb::ControlRequest& request, std::span<std::uint8_t> data, int timeout_ms) {
  const std::string call = words("in", request) + std::to_string(data.size()) + " bytes" + limit(timeout_ms);
  if (const auto told = bus_.told(call)) return *told;
  const Setup setup{kVendorIn, request.request, request.value, request.index, static_cast<std::uint16_t>(data.size())};
  UsbStatus status{};
  const auto reply = control(setup, {}, timeout_ms, status);
  if (!reply) return failed(status);
  const std::size_t count = std::min(data.size(), reply->data.size());
  std::copy_n(reply->data.begin(), count, data.begin());
  return count;
}

UsbResult FakePort::control_out(const device::usb::ControlRequest& request, std::span<const std::uint8_t> data, int timeout_ms) {
  if (const auto told = bus_.told(words("out", request) + hex(data) + limit(timeout_ms))) return *told;
  const Setup setup{kVendorOut, request.request, request.value, request.index, static_cast<std::uint16_t>(data.size())};
  UsbStatus status{};
  if (!control(setup, data, timeout_ms, status)) return failed(status);
  return data.size();
}

UsbResult FakePort::bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> data, int timeout_ms) {
  const std::string call = "bulk in " + hex(endpoint) + " " + std::to_string(data.size()) + " bytes" + limit(timeout_ms);
  if (const auto told = bus_.told(call)) return *told;
  bus_.settle();
  UrbQueue* const urbs = queue(endpoint);
  if (plug_->is_gone) return failed(UsbStatus::NoDevice);
  if (urbs == nullptr) return failed(UsbStatus::Failed);
  const std::int64_t deadline_ns = bus_.now_ns() + timeout_ms * core::kNanosecondsPerMillisecond;
  sync_result_.reset();
  urbs->submit(kSyncId, data.size());
  bus_.settle();
  while (!sync_result_ && bus_.now_ns() < deadline_ns) bus_.step(deadline_ns);
  if (!sync_result_) sync_result_ = urbs->cancel(kSyncId);
  if (!sync_result_) return failed(UsbStatus::Failed);
  const FinishedUrb urb = *std::exchange(sync_result_, std::nullopt);
  if (urb.status == UsbStatus::Cancelled && urb.bytes.empty()) return failed(UsbStatus::TimedOut);
  if (urb.status != UsbStatus::Completed && urb.status != UsbStatus::Cancelled) return failed(urb.status);
  const std::size_t count = std::min(data.size(), urb.bytes.size());
  std::copy_n(urb.bytes.begin(), count, data.begin());
  return count;
}

UsbResult FakePort::bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data, int timeout_ms) {
  if (const auto told = bus_.told("bulk out " + hex(endpoint) + " " + hex(data) + limit(timeout_ms))) return *told;
  bus_.spend(bus_.request_ns);
  if (plug_->is_gone) return failed(UsbStatus::NoDevice);
  if (queue(endpoint) == nullptr) return failed(UsbStatus::Failed);
  plug_->device.bulk_out(endpoint, data, bus_.now_ns());
  bus_.settle();
  return data.size();
}

UsbResult FakePort::clear_halt(std::uint8_t endpoint) {
  if (const auto told = bus_.told("clear halt " + hex(endpoint))) return *told;
  bus_.spend(bus_.request_ns);
  if (plug_->is_gone) return failed(UsbStatus::NoDevice);
  UrbQueue* const urbs = queue(endpoint);
  if (urbs == nullptr) return failed(UsbStatus::Failed);
  urbs->clear_halt();
  plug_->device.clear_halt(endpoint);
  return 0;
}

core::Status FakePort::prepare_transfers(std::uint8_t endpoint, std::size_t count, std::size_t bytes,
                                         device::usb::TransferListener& listener) {
  if (bus_.told(std::to_string(count) + " transfers " + hex(endpoint) + " of " + std::to_string(bytes) + " bytes")) {
    return core::fail(core::ErrorCode::Failed, "no transfers");
  }
  const auto packet = max_packet_bytes(endpoint);
  if (!packet) return tl::make_unexpected(packet.error());
  if (count == 0 || bytes == 0 || bytes % *packet != 0) {
    return core::fail(core::ErrorCode::InvalidArgument, "transfers of " + std::to_string(bytes) + " bytes are not whole packets");
  }
  if (!in_flight_.empty()) return core::fail(core::ErrorCode::WrongState, "transfers are in flight");
  (void)queue(endpoint);
  stream_endpoint_ = endpoint;
  transfer_count_ = count;
  transfer_bytes_ = bytes;
  listener_ = &listener;
  return {};
}

UsbStatus FakePort::submit(std::size_t index) noexcept {
  if (plug_->is_gone || !bus_.accepts_submit()) return UsbStatus::NoDevice;
  if (index >= transfer_count_ || !in_flight_.insert(index).second) return UsbStatus::Failed;
  queues_.at(stream_endpoint_).submit(index, transfer_bytes_);
  return UsbStatus::Completed;
}

void FakePort::cancel(std::size_t index) noexcept {
  const auto found = queues_.find(stream_endpoint_);
  if (found == queues_.end()) return;
  auto cancelled = found->second.cancel(index);
  if (!cancelled || bus_.swallows_cancel) return;
  completions_.push_back({std::move(*cancelled), bus_.now_ns() + bus_.cancel_ns});
}

void FakePort::release_transfers() noexcept {
  bus_.abandoned_transfers_ += in_flight();
  in_flight_.clear();
  completions_.clear();
  listener_ = nullptr;
  transfer_count_ = 0;
}

void FakePort::wait(std::int64_t deadline_ns) noexcept {
  bus_.settle();
  while (!has_news_ && bus_.clock_.now_ns() < deadline_ns) bus_.step(bus_.raw_of(deadline_ns));
  has_news_ = false;
}

std::int64_t FakePort::next_event_ns(std::int64_t now_ns) const {
  std::int64_t next_ns = std::numeric_limits<std::int64_t>::max();
  if (!completions_.empty()) next_ns = completions_.front().due_ns;
  const bool is_waiting = std::any_of(queues_.begin(), queues_.end(), [](const auto& entry) { return entry.second.is_waiting(); });
  if (is_waiting && !plug_->is_gone) {
    const std::int64_t packet_ns = plug_->device.next_packet_ns(now_ns);
    next_ns = std::min(next_ns, packet_ns > now_ns ? packet_ns : now_ns + kFrameNs);
  }
  return next_ns;
}

void FakePort::note(std::vector<FinishedUrb> finished) {
  for (FinishedUrb& urb : finished) {
    if (urb.id == kSyncId) {
      sync_result_ = std::move(urb);
      continue;
    }
    const std::uint64_t number = bus_.completions_++;
    if (bus_.completion_status) urb.status = bus_.completion_status(number, urb.status);
    const std::int64_t late_ns = bus_.lateness_ns ? std::max<std::int64_t>(bus_.lateness_ns(), 0) : 0;
    // One thread notices them all, in their order.
    const std::int64_t earliest_ns = completions_.empty() ? 0 : completions_.back().due_ns;
    completions_.push_back({std::move(urb), std::max(earliest_ns, bus_.now_ns() + late_ns)});
  }
}

bool FakePort::deliver(std::int64_t now_ns) {
  bool has_moved = false;
  while (!completions_.empty() && completions_.front().due_ns <= now_ns) {
    const FinishedUrb urb = std::move(completions_.front().urb);
    completions_.pop_front();
    in_flight_.erase(urb.id);
    has_news_ = true;
    has_moved = true;
    if (listener_ != nullptr) listener_->on_transfer(static_cast<std::size_t>(urb.id), urb.status, urb.bytes, now_ns);
  }
  return has_moved;
}

bool FakePort::advance(std::int64_t now_ns) {
  if (!plug_->is_gone) {
    for (auto& [endpoint, urbs] : queues_) {
      if (urbs.is_waiting()) note(urbs.advance(plug_->device, now_ns));
    }
  }
  return deliver(now_ns);
}

void FakePort::lose() {
  for (auto& [endpoint, urbs] : queues_) note(urbs.end_all(UsbStatus::NoDevice));
}

}  // namespace dts::emulator
