// SPDX-License-Identifier: Apache-2.0
#include "usb/umockdev/usbfs_node.h"

#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace dts::emulator {
namespace {

using device::usb::UsbStatus;

constexpr std::size_t kSetupBytes = 8;
constexpr int kOneSlot = 4096;  // the smallest pipe: one write of any length fills it
constexpr std::uint32_t kCapabilities = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                        USBDEVFS_CAP_BULK_SCATTER_GATHER | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;

/// As the kernel tells it in usbdevfs_urb.status (Documentation/driver-api/usb/error-codes.rst).
int urb_status(UsbStatus status) {
  switch (status) {
    case UsbStatus::Completed: return 0;
    case UsbStatus::Stall: return -EPIPE;
    case UsbStatus::NoDevice: return -ESHUTDOWN;
    case UsbStatus::Overflow: return -EOVERFLOW;
    case UsbStatus::TimedOut:
    case UsbStatus::Cancelled: return -ENOENT;
    case UsbStatus::NoMemory:
    case UsbStatus::Failed: break;
  }
  return -EPROTO;
}

GObjectPtr<UMockdevIoctlData> resolved(UMockdevIoctlData* data, std::size_t offset, std::size_t length) {
  return GObjectPtr<UMockdevIoctlData>(umockdev_ioctl_data_resolve(data, offset, length, nullptr));
}

usbdevfs_urb& urb_of(const UMockdevIoctlData* data) { return *reinterpret_cast<usbdevfs_urb*>(data->data); }

Setup setup_of(const guint8* bytes) {
  const auto word = [bytes](int at) { return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8); };
  return {bytes[0], bytes[1], word(2), word(4), word(6)};
}

}  // namespace

UsbfsNode::UsbfsNode(std::string path, EmulatedDevice& device, Pace pace, const core::Clock& clock, std::function<void()> leave)
    : path_(std::move(path)), handler_(umockdev_ioctl_base_new()) {
  ::unlink(path_.c_str());
  if (::mkfifo(path_.c_str(), 0666) != 0) throw std::runtime_error("no FIFO at " + path_);
  fifo_ = ::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fifo_ < 0 || ::fcntl(fifo_, F_SETPIPE_SZ, kOneSlot) < 0) throw std::runtime_error("cannot use the FIFO at " + path_);
  update_readiness();
  g_signal_connect(handler_.get(), "handle-ioctl", G_CALLBACK(&UsbfsNode::on_ioctl), this);
  running_ = std::make_shared<RunningDevice>(
      device, pace, clock, [this](FinishedTransfer transfer) { finish(std::move(transfer)); }, std::move(leave));
}

UsbfsNode::~UsbfsNode() {
  pull();
  ::close(fifo_);
}

std::shared_ptr<RunningDevice> UsbfsNode::running() const {
  const std::lock_guard lock(mutex_);
  return running_;
}

void UsbfsNode::pull() {
  std::shared_ptr<RunningDevice> running;
  {
    const std::lock_guard lock(mutex_);
    is_gone_ = true;
    running = std::exchange(running_, nullptr);
  }
  if (running != nullptr) running->end_all(UsbStatus::NoDevice);
  running.reset();  // its thread ends; an ioctl under way may hold it a moment
                    // longer
  const std::lock_guard lock(mutex_);
  for (auto& [id, urb] : flying_) {
    urb.result = {id, UsbStatus::NoDevice, {}, 0};
    finished_.push_back(std::move(urb));
  }
  flying_.clear();
  update_readiness();
  ::unlink(path_.c_str());
}

void UsbfsNode::occupy(bool is_occupied) {
  const std::lock_guard lock(mutex_);
  is_occupied_ = is_occupied;
}

std::size_t UsbfsNode::urbs_in_flight() const {
  const std::lock_guard lock(mutex_);
  return flying_.size();
}

void UsbfsNode::update_readiness() {
  const bool should_be_full = finished_.empty() && !is_gone_;
  if (should_be_full == is_fifo_full_) return;
  char byte = 0;
  const ssize_t moved = should_be_full ? ::write(fifo_, &byte, 1) : ::read(fifo_, &byte, 1);
  if (moved == 1) is_fifo_full_ = should_be_full;
}

void UsbfsNode::finish(FinishedTransfer transfer) {
  const std::lock_guard lock(mutex_);
  const auto urb = flying_.find(transfer.id);
  if (urb == flying_.end()) return;
  urb->second.result = std::move(transfer);
  finished_.push_back(std::move(urb->second));
  flying_.erase(urb);
  update_readiness();
}

gboolean UsbfsNode::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
  const int error = static_cast<UsbfsNode*>(self)->answer(client);
  umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
  return TRUE;
}

int UsbfsNode::answer(UMockdevIoctlClient* client) {
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);  // borrowed
  const auto request = static_cast<unsigned long>(umockdev_ioctl_client_get_request(client));
  switch (request) {
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY: return reap(client, argument);
    case USBDEVFS_DISCARDURB: return discard(argument);
    case USBDEVFS_RELEASEINTERFACE: return release(client);
    default: break;
  }
  if (running() == nullptr) return ENODEV;
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      const auto place = resolved(argument, 0, sizeof kCapabilities);
      std::memcpy(place->data, &kCapabilities, sizeof kCapabilities);
      return 0;
    }
    case USBDEVFS_DISCONNECT_CLAIM:
    case USBDEVFS_CLAIMINTERFACE: return claim(client);
    case USBDEVFS_CLEAR_HALT: return clear_halt(argument);
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_RESETEP: return 0;
    case USBDEVFS_RESET:
      if (const auto running_now = running()) running_now->power_up();
      return 0;
    case USBDEVFS_GETDRIVER: return ENODATA;
    case USBDEVFS_SUBMITURB: return submit(client, argument);
    default: return ENOTTY;
  }
}

int UsbfsNode::claim(UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  const bool is_others = holder_ != nullptr && holder_.get() != client && umockdev_ioctl_client_get_connected(holder_.get()) == TRUE;
  if (is_occupied_ || is_others) return EBUSY;
  if (holder_.get() != client) holder_.reset(UMOCKDEV_IOCTL_CLIENT(g_object_ref(client)));
  return 0;
}

int UsbfsNode::release(const UMockdevIoctlClient* client) {
  const std::lock_guard lock(mutex_);
  if (is_gone_) return ENODEV;
  if (holder_.get() != client) return EINVAL;
  holder_.reset();
  return 0;
}

int UsbfsNode::clear_halt(UMockdevIoctlData* argument) {
  unsigned int endpoint = 0;
  const auto place = resolved(argument, 0, sizeof endpoint);
  std::memcpy(&endpoint, place->data, sizeof endpoint);
  const auto running_now = running();
  if (running_now == nullptr) return ENODEV;
  running_now->clear_halt(static_cast<std::uint8_t>(endpoint));
  return 0;
}

int UsbfsNode::submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  Urb urb;
  urb.client = client;
  urb.data = resolved(argument, 0, sizeof(usbdevfs_urb));
  if (urb.data == nullptr) return EFAULT;
  const usbdevfs_urb request = urb_of(urb.data.get());
  const auto length = static_cast<std::size_t>(std::max(request.buffer_length, 0));
  if (length > 0) urb.buffer = resolved(urb.data.get(), offsetof(usbdevfs_urb, buffer), length).get();  // `data` keeps it alive
  if (request.type == USBDEVFS_URB_TYPE_CONTROL && length < kSetupBytes) return EINVAL;
  // Copied before anybody hears of it: the transfer may be finished at once.
  const std::vector<std::uint8_t> bytes =
      urb.buffer == nullptr ? std::vector<std::uint8_t>{} : std::vector<std::uint8_t>(urb.buffer->data, urb.buffer->data + length);
  std::shared_ptr<RunningDevice> running_now;
  std::uint64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    if (running_ == nullptr) return ENODEV;
    running_now = running_;
    id = next_id_++;
    flying_.emplace(id, std::move(urb));
  }
  start(id, request.type, request.endpoint, bytes,
        *running_now);  // a device that goes away meanwhile ends it: pull
  return 0;
}

void UsbfsNode::start(std::uint64_t id, int type, std::uint8_t endpoint, std::span<const std::uint8_t> bytes, RunningDevice& running) {
  if (type == USBDEVFS_URB_TYPE_CONTROL) {
    const Setup setup = setup_of(bytes.data());
    const bool is_in = (setup.request_type & 0x80) != 0;
    running.control(id, setup, is_in ? std::span<const std::uint8_t>{} : bytes.subspan(kSetupBytes));
  } else if ((endpoint & 0x80) != 0) {
    running.bulk_in(id, endpoint, bytes.size());
  } else {
    running.bulk_out(id, endpoint, bytes);
  }
}

int UsbfsNode::reap(const UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(finished_.begin(), finished_.end(), [client](const Urb& urb) { return urb.client == client; });
  if (found == finished_.end()) return is_gone_ ? ENODEV : EAGAIN;
  Urb urb = std::move(*found);
  finished_.erase(found);
  usbdevfs_urb& told = urb_of(urb.data.get());
  const std::size_t offset = told.type == USBDEVFS_URB_TYPE_CONTROL ? kSetupBytes : 0;
  const auto room = static_cast<std::size_t>(std::max(told.buffer_length, 0)) - offset;
  const std::size_t count = std::min(urb.result.bytes.size(), room);
  if (urb.buffer != nullptr && count > 0) std::memcpy(urb.buffer->data + offset, urb.result.bytes.data(), count);
  told.status = urb_status(urb.result.status);
  told.actual_length = static_cast<int>(std::min(urb.result.length, room));
  const auto place = resolved(argument, 0, sizeof(void*));
  umockdev_ioctl_data_set_ptr(place.get(), 0, urb.data.get());
  update_readiness();
  return 0;
}

int UsbfsNode::discard(const UMockdevIoctlData* argument) {
  gulong address = 0;
  std::memcpy(&address, argument->data, sizeof address);
  std::shared_ptr<RunningDevice> running_now;
  std::uint64_t id = 0;
  {
    const std::lock_guard lock(mutex_);
    const auto urb =
        std::find_if(flying_.begin(), flying_.end(), [address](const auto& entry) { return entry.second.data->client_addr == address; });
    if (urb == flying_.end() || running_ == nullptr) return is_gone_ ? ENODEV : EINVAL;
    id = urb->first;
    running_now = running_;
  }
  return running_now->cancel(id) ? 0 : EINVAL;
}

}  // namespace dts::emulator
