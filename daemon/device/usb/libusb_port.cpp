// SPDX-License-Identifier: Apache-2.0
#include "device/usb/libusb_port.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <limits>
#include <string>
#include <thread>
#include <utility>

#include "device/usb/libusb_error.h"

namespace dts::device::usb {
namespace {

using core::ErrorCode;

constexpr int kInterface = 0;
constexpr std::uint8_t kVendorIn = 0xC0;
constexpr std::uint8_t kVendorOut = 0x40;
constexpr std::size_t kPacketSizeBits = 0x7ff;  // the bits above are transactions per microframe
constexpr std::size_t kMaxTransferBytes = 1 << 20;
constexpr int kLastCallbackMs = 1000;  // limit from the end of `on_transfer` to the end of the callback, which are only a few instructions

struct FreeConfig {
  void operator()(libusb_config_descriptor* config) const noexcept { libusb_free_config_descriptor(config); }
};

}  // namespace

struct LibusbPort::Prepared {
  Prepared(LibusbPort& owner, std::size_t number, std::size_t bytes)
      : port(owner), index(number), buffer(bytes), transfer(libusb_alloc_transfer(0)) {}
  ~Prepared() { libusb_free_transfer(transfer); }
  Prepared(const Prepared&) = delete;
  Prepared& operator=(const Prepared&) = delete;

  LibusbPort& port;
  std::size_t index;
  std::vector<std::uint8_t> buffer;
  libusb_transfer* transfer;
  std::atomic<int> uses{0};  ///< Submitted transfers plus running callbacks: a callback may submit before it ends.
};

LibusbPort::LibusbPort(UsbUnit unit, libusb_device* device, libusb_device_handle* handle, core::Clock& clock, core::Log log,
                       std::function<void()> on_closed)
    : unit_(std::move(unit)),
      handle_(handle),
      device_(libusb_ref_device(device)),
      clock_(clock),
      log_(std::move(log)),
      on_closed_(std::move(on_closed)) {}

LibusbPort::~LibusbPort() {
  release_transfers();
  if (is_claimed_) libusb_release_interface(handle_.get(), kInterface);
  libusb_unref_device(device_);  // the open handle has its own reference
  handle_.close();
  on_closed_();
}

core::Status LibusbPort::claim() {
  libusb_set_auto_detach_kernel_driver(handle_.get(), 1);
  if (const int error = libusb_claim_interface(handle_.get(), kInterface); error != 0)
    return tl::make_unexpected(open_error(error, 0, unit_));
  is_claimed_ = true;
  return {};
}

core::Result<std::size_t> LibusbPort::max_packet_bytes(std::uint8_t endpoint) const {
  libusb_config_descriptor* config = nullptr;
  const int error = libusb_get_active_config_descriptor(device_, &config);
  if (error == LIBUSB_ERROR_NO_DEVICE) return tl::make_unexpected(open_error(error, 0, unit_));
  if (error == 0) {
    const std::unique_ptr<libusb_config_descriptor, FreeConfig> guard(config);
    const bool has_interface = config->bNumInterfaces > kInterface && config->interface[kInterface].num_altsetting > 0;
    const libusb_interface_descriptor* face = has_interface ? &config->interface[kInterface].altsetting[0] : nullptr;
    for (int i = 0; face != nullptr && i < face->bNumEndpoints; ++i) {
      const std::size_t bytes = face->endpoint[i].wMaxPacketSize & kPacketSizeBits;
      if (face->endpoint[i].bEndpointAddress == endpoint && bytes > 0) return bytes;
    }
  }
  return core::fail(ErrorCode::NotFound, name_of(unit_) + " has no endpoint " + std::to_string(endpoint) + " in its interface 0",
                    "check that the device is the product that its USB IDs name");
}

bool LibusbPort::is_high_speed() const noexcept { return libusb_get_device_speed(device_) >= LIBUSB_SPEED_HIGH; }

UsbResult LibusbPort::control_in(const ControlRequest& request, std::span<std::uint8_t> data, int timeout_ms) {
  return handle_.control(kVendorIn, request, {{}, data}, timeout_ms);
}

UsbResult LibusbPort::control_out(const ControlRequest& request, std::span<const std::uint8_t> data, int timeout_ms) {
  return handle_.control(kVendorOut, request, {data, {}}, timeout_ms);
}

UsbResult LibusbPort::bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> data, int timeout_ms) {
  return handle_.bulk(endpoint, {{}, data}, timeout_ms);
}

UsbResult LibusbPort::bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data, int timeout_ms) {
  return handle_.bulk(endpoint, {data, {}}, timeout_ms);
}

UsbResult LibusbPort::clear_halt(std::uint8_t endpoint) {
  if (const int error = libusb_clear_halt(handle_.get(), endpoint); error != 0) return tl::make_unexpected(status_of_error(error));
  return std::size_t{0};
}

core::Status LibusbPort::prepare_transfers(std::uint8_t endpoint, std::size_t count, std::size_t bytes, TransferListener& listener) {
  release_transfers();
  if (bytes == 0 || bytes > kMaxTransferBytes)
    return core::fail(ErrorCode::LimitExceeded, "transfers of " + std::to_string(bytes) + " bytes are outside 1 to 1048576");
  listener_ = &listener;
  for (std::size_t i = 0; i < count; ++i) {
    auto prepared = std::make_unique<Prepared>(*this, i, bytes);
    if (prepared->transfer == nullptr) {
      release_transfers();
      return core::fail(ErrorCode::Failed, "no memory for USB transfers");
    }
    libusb_fill_bulk_transfer(prepared->transfer, handle_.get(), endpoint, prepared->buffer.data(), static_cast<int>(bytes),
                              &LibusbPort::on_finished, prepared.get(), 0);
    prepared_.push_back(std::move(prepared));
  }
  return {};
}

UsbStatus LibusbPort::submit(std::size_t index) noexcept {
  if (index >= prepared_.size()) return UsbStatus::Failed;
  Prepared& prepared = *prepared_[index];
  prepared.uses.fetch_add(1, std::memory_order_release);  // pairs with on_finished: the event thread sees earlier writes
  const int error = libusb_submit_transfer(prepared.transfer);
  if (error == 0) return UsbStatus::Completed;
  prepared.uses.fetch_sub(1, std::memory_order_release);  // pairs with are_all_over
  return status_of_error(error);
}

void LibusbPort::on_finished(libusb_transfer* transfer) {
  auto* prepared = static_cast<Prepared*>(transfer->user_data);
  LibusbPort& port = prepared->port;
  const std::int64_t stamp_ns = port.clock_.raw_ns();
  static_cast<void>(prepared->uses.load(std::memory_order_acquire));  // pairs with submit
  const auto length = std::min(static_cast<std::size_t>(std::max(transfer->actual_length, 0)), prepared->buffer.size());
  port.listener_->on_transfer(prepared->index, status_of_transfer(transfer->status), {prepared->buffer.data(), length}, stamp_ns);
  port.bell_.ring();
  prepared->uses.fetch_sub(1, std::memory_order_release);  // pairs with are_all_over; must be last: the memory may be freed now
}

void LibusbPort::cancel(std::size_t index) noexcept {
  // libusb returns an error if the transfer is not in flight or has already ended; this is harmless.
  if (index < prepared_.size()) static_cast<void>(libusb_cancel_transfer(prepared_[index]->transfer));
}

bool LibusbPort::are_all_over() const noexcept {
  return std::all_of(prepared_.begin(), prepared_.end(),
                     [](const auto& prepared) { return prepared->uses.load(std::memory_order_acquire) == 0; });  // pairs with on_finished
}

void LibusbPort::release_transfers() noexcept {
  for (int waited_ms = 0; !are_all_over() && waited_ms < kLastCallbackMs; ++waited_ms) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  if (!are_all_over()) {
    log_.error(name_of(unit_) + ": some transfers never ended; their memory is not freed");
    for (auto& prepared : prepared_) static_cast<void>(prepared.release());
  }
  prepared_.clear();
}

void LibusbPort::wait(std::int64_t deadline_ns) noexcept {
  const std::int64_t left_ns = std::max<std::int64_t>(deadline_ns - clock_.now_ns(), 0);
  // Rounded up: a reader that wakes before its deadline would call `wait` again and again.
  const std::int64_t left_ms = (left_ns + core::kNanosecondsPerMillisecond - 1) / core::kNanosecondsPerMillisecond;
  bell_.wait(static_cast<int>(std::min<std::int64_t>(left_ms, std::numeric_limits<int>::max())));
}

}  // namespace dts::device::usb
