// SPDX-License-Identifier: Apache-2.0
#include "device/usb/libusb_handle.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "core/doorbell.h"
#include "device/usb/libusb_error.h"

namespace dts::device::usb {
namespace {

constexpr int kGraceMs = 1000;  // from libusb's timeout, or from a cancel, to the callback: the event thread may be busy
constexpr std::uint8_t kDeviceToHost = LIBUSB_ENDPOINT_IN;
constexpr std::size_t kMaxControlBytes = 4096;  // limit of usbfs
constexpr std::uint16_t kEnglish = 0x0409;

}  // namespace

/// A synchronous transfer. It stays on the heap until its callback has ended; it leaks if the callback never runs.
struct LibusbHandle::Waited {
  struct FreeTransfer {
    void operator()(libusb_transfer* allocated) const noexcept { libusb_free_transfer(allocated); }
  };

  explicit Waited(std::size_t bytes) : buffer(bytes), transfer(libusb_alloc_transfer(0)) {}

  std::vector<std::uint8_t> buffer;
  std::unique_ptr<libusb_transfer, FreeTransfer> transfer;
  std::atomic<bool> is_over{false};
  core::Doorbell bell;
};

void LibusbHandle::close() noexcept {
  if (handle_ != nullptr) libusb_close(std::exchange(handle_, nullptr));
}

/// Returns nullptr if memory or descriptors are used up. The callers may not throw: they run on the thread of a rig.
std::unique_ptr<LibusbHandle::Waited> LibusbHandle::make_waited(std::size_t bytes) try {
  auto waited = std::make_unique<Waited>(bytes);
  return waited->transfer == nullptr ? nullptr : std::move(waited);
} catch (const std::exception&) {
  return nullptr;
}

void LibusbHandle::on_waited(libusb_transfer* transfer) {
  auto* waited = static_cast<Waited*>(transfer->user_data);
  waited->is_over.store(true, std::memory_order_release);  // pairs with run
  waited->bell.ring();                                     // must be last: the waiting thread frees `waited`
}

UsbResult LibusbHandle::run(std::unique_ptr<Waited> waited, std::span<std::uint8_t> received, std::size_t offset, int timeout_ms) {
  const auto is_over = [&] { return waited->is_over.load(std::memory_order_acquire); };  // pairs with on_waited
  if (const int error = libusb_submit_transfer(waited->transfer.get()); error != 0) return tl::make_unexpected(status_of_error(error));
  // Only after the bell has rung is the callback over and the memory may be freed.
  bool has_rung = waited->bell.wait(std::max(timeout_ms, 1) + kGraceMs);
  if (!has_rung) {
    libusb_cancel_transfer(waited->transfer.get());
    has_rung = waited->bell.wait(kGraceMs);
  }
  if (!has_rung || !is_over()) {
    static_cast<void>(waited.release());  // leaked: libusb may still write to it
    return tl::make_unexpected(UsbStatus::Failed);
  }
  const libusb_transfer& transfer = *waited->transfer;
  const auto length = static_cast<std::size_t>(std::max(transfer.actual_length, 0));
  const UsbStatus status = status_of_transfer(transfer.status);
  const bool has_some = status == UsbStatus::TimedOut && length > 0;
  if (status != UsbStatus::Completed && !has_some) return tl::make_unexpected(status);
  const std::size_t count = std::min({length, received.size(), waited->buffer.size() - offset});
  std::copy_n(waited->buffer.begin() + static_cast<std::ptrdiff_t>(offset), count, received.begin());
  return received.empty() ? length : count;
}

UsbResult LibusbHandle::control(std::uint8_t type, const ControlRequest& request, const Data& data, int timeout_ms) {
  const std::size_t length = std::max(data.sent.size(), data.received.size());
  if (length > kMaxControlBytes) return tl::make_unexpected(UsbStatus::Failed);
  const std::lock_guard lock(mutex_);
  auto waited = make_waited(LIBUSB_CONTROL_SETUP_SIZE + length);
  if (waited == nullptr) return tl::make_unexpected(UsbStatus::NoMemory);
  libusb_fill_control_setup(waited->buffer.data(), type, request.request, request.value, request.index, static_cast<std::uint16_t>(length));
  std::copy(data.sent.begin(), data.sent.end(), waited->buffer.begin() + LIBUSB_CONTROL_SETUP_SIZE);
  libusb_fill_control_transfer(waited->transfer.get(), handle_, waited->buffer.data(), &LibusbHandle::on_waited, waited.get(),
                               static_cast<unsigned>(std::max(timeout_ms, 1)));
  return run(std::move(waited), data.received, LIBUSB_CONTROL_SETUP_SIZE, timeout_ms);
}

UsbResult LibusbHandle::bulk(std::uint8_t endpoint, const Data& data, int timeout_ms) {
  const std::lock_guard lock(mutex_);
  auto waited = make_waited(std::max(data.sent.size(), data.received.size()));
  if (waited == nullptr) return tl::make_unexpected(UsbStatus::NoMemory);
  std::copy(data.sent.begin(), data.sent.end(), waited->buffer.begin());
  libusb_fill_bulk_transfer(waited->transfer.get(), handle_, endpoint, waited->buffer.data(), static_cast<int>(waited->buffer.size()),
                            &LibusbHandle::on_waited, waited.get(), static_cast<unsigned>(std::max(timeout_ms, 1)));
  return run(std::move(waited), data.received, 0, timeout_ms);
}

std::string LibusbHandle::string_descriptor(std::uint8_t index, int timeout_ms) {
  std::array<std::uint8_t, 255> bytes{};
  const auto value = static_cast<std::uint16_t>(LIBUSB_DT_STRING << 8 | index);
  const auto length = control(kDeviceToHost, {LIBUSB_REQUEST_GET_DESCRIPTOR, value, kEnglish}, {{}, bytes}, timeout_ms);
  if (!length || *length < 2 || bytes[1] != LIBUSB_DT_STRING) return {};
  std::string text;
  for (std::size_t i = 2; i + 1 < std::min<std::size_t>(*length, bytes[0]); i += 2) {  // UTF-16LE; keeps printable ASCII only
    if (bytes[i + 1] == 0 && bytes[i] >= 0x20 && bytes[i] < 0x7f) text += static_cast<char>(bytes[i]);
  }
  return text;
}

}  // namespace dts::device::usb
