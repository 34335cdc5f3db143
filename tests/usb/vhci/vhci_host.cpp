// SPDX-License-Identifier: Apache-2.0
#include "usb/vhci/vhci_host.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <mutex>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "usb/emulator/running_device.h"
#include "usb/vhci/usbip_message.h"

namespace dts::emulator {
namespace {

using core::ErrorCode;
using device::usb::UsbStatus;

constexpr const char* kAttach = "/sys/devices/platform/vhci_hcd.0/attach";
constexpr int kPorts = 8;  // of the high-speed hub; the super-speed ones come behind
constexpr std::uint32_t kMaxTransferBytes = 1 << 20;
constexpr int kFullSpeed = 2;  // enum usb_device_speed, include/uapi/linux/usb/ch9.h
constexpr int kHighSpeed = 3;

int urb_status(UsbStatus status) {
  switch (status) {
    case UsbStatus::Completed: return 0;
    case UsbStatus::Stall: return -EPIPE;
    case UsbStatus::NoDevice: return -ESHUTDOWN;
    case UsbStatus::Overflow: return -EOVERFLOW;
    case UsbStatus::TimedOut:
    case UsbStatus::Cancelled: return -ECONNRESET;
    case UsbStatus::NoMemory:
    case UsbStatus::Failed: break;
  }
  return -EPROTO;
}

bool receive(int socket, std::span<std::uint8_t> bytes) {
  return bytes.empty() || ::recv(socket, bytes.data(), bytes.size(), MSG_WAITALL) == static_cast<ssize_t>(bytes.size());
}

bool transmit(int socket, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace

/// One plugged device: a thread reads what the kernel wants; what the device finishes goes back from its own thread.
class VhciHost::Connection {
 public:
  Connection(int socket, EmulatedDevice& device)
      : socket_(socket),
        running_(
            device, Pace::RealTime, clock_, [this](FinishedTransfer transfer) { finish(std::move(transfer)); }, [] {}),
        thread_([this] { serve(); }) {}
  ~Connection() {
    ::shutdown(socket_, SHUT_RDWR);  // the kernel takes it for a pulled plug
    thread_.join();
    ::close(socket_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  [[nodiscard]] RunningDevice& running() noexcept { return running_; }

 private:
  void serve() {
    UsbipMessage message;
    while (receive(socket_, message.bytes)) {
      if (message.command() == UsbipMessage::kUnlink) {
        unlink(message);
      } else if (message.command() != UsbipMessage::kSubmit || !submit(message)) {
        return;
      }
    }
  }

  bool submit(const UsbipMessage& message) {
    if (message.length() > kMaxTransferBytes) return false;
    std::vector<std::uint8_t> out_data(message.is_in() ? 0 : message.length());
    if (!receive(socket_, out_data)) return false;
    const auto endpoint = static_cast<std::uint8_t>(message.endpoint());
    if (endpoint == 0) {
      const auto* bytes = message.bytes.data() + 40;
      const auto word = [bytes](int at) { return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8); };
      running_.control(message.seqnum(), {bytes[0], bytes[1], word(2), word(4), word(6)}, out_data);
    } else if (message.is_in()) {
      running_.bulk_in(message.seqnum(), static_cast<std::uint8_t>(endpoint | 0x80), message.length());
    } else {
      running_.bulk_out(message.seqnum(), endpoint, out_data);
    }
    return true;
  }

  void unlink(const UsbipMessage& message) {
    const bool was_pending = running_.cancel(message.word(20));
    UsbipMessage reply;
    reply.set_word(0, UsbipMessage::kReturnUnlink);
    reply.set_word(4, message.seqnum());
    reply.set_word(20, static_cast<std::uint32_t>(was_pending ? -ECONNRESET : 0));
    const std::lock_guard lock(send_mutex_);
    transmit(socket_, reply.bytes);
  }

  void finish(FinishedTransfer transfer) {
    if (transfer.status == UsbStatus::Cancelled) return;  // only `unlink` cancels, and answers itself
    UsbipMessage reply;
    reply.set_word(0, UsbipMessage::kReturnSubmit);
    reply.set_word(4, static_cast<std::uint32_t>(transfer.id));
    reply.set_word(20, static_cast<std::uint32_t>(urb_status(transfer.status)));
    reply.set_word(24, static_cast<std::uint32_t>(transfer.length));
    reply.set_word(32, UsbipMessage::kNotIsochronous);
    std::vector<std::uint8_t> bytes(reply.bytes.begin(), reply.bytes.end());
    bytes.insert(bytes.end(), transfer.bytes.begin(), transfer.bytes.end());
    const std::lock_guard lock(send_mutex_);
    transmit(socket_, bytes);
  }

  int socket_;
  std::mutex send_mutex_;
  core::SystemClock clock_;
  RunningDevice running_;
  std::thread thread_;
};

core::Result<std::unique_ptr<VhciHost>> VhciHost::create() {
  if (::access(kAttach, F_OK) != 0)
    return core::fail(ErrorCode::NotFound, std::string("there is no virtual USB host controller: ") + kAttach + " is missing",
                      "as root: modprobe vhci-hcd; some kernels (cloud) have no such module");
  if (::access(kAttach, W_OK) != 0)
    return core::fail(ErrorCode::NotAllowed, std::string("no permission to write to ") + kAttach, "run it as root");
  return std::unique_ptr<VhciHost>(new VhciHost);
}

VhciHost::~VhciHost() = default;

core::Status VhciHost::plug(EmulatedDevice& device) {
  if (plugged_.contains(&device)) return {};
  const int port = ports_.try_emplace(&device, static_cast<int>(ports_.size())).first->second;
  if (port >= kPorts) return core::fail(ErrorCode::LimitExceeded, "the virtual host controller has 8 ports only");
  int sockets[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) return core::fail_errno(errno, "socketpair");
  const int devid = 1 << 16 | (port + 2);  // bus and device at the far end: any
  const int speed = device.descriptors().is_high_speed ? kHighSpeed : kFullSpeed;
  const std::string line =
      std::to_string(port) + " " + std::to_string(sockets[1]) + " " + std::to_string(devid) + " " + std::to_string(speed);
  const int attach = ::open(kAttach, O_WRONLY | O_CLOEXEC);
  const bool is_attached = attach >= 0 && ::write(attach, line.data(), line.size()) == static_cast<ssize_t>(line.size());
  const int error = errno;
  if (attach >= 0) ::close(attach);
  ::close(sockets[1]);  // the kernel has its own reference
  if (!is_attached) {
    ::close(sockets[0]);
    return core::fail_errno(error, std::string("cannot plug into ") + kAttach, "a port that was just unplugged takes a moment; try again");
  }
  plugged_.emplace(&device, std::make_unique<Connection>(sockets[0], device));
  return {};
}

void VhciHost::unplug(EmulatedDevice& device) { plugged_.erase(&device); }

void VhciHost::locked(EmulatedDevice& device, const std::function<void()>& action) {
  const auto plugged = plugged_.find(&device);
  if (plugged == plugged_.end()) return action();
  plugged->second->running().locked([&] { action(); });
}

}  // namespace dts::emulator
