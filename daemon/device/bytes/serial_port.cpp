// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/serial_port.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <utility>

#include "device/bytes/descriptor_link.h"
#include "device/bytes/raw_mode.h"
#include "device/bytes/usb_tty.h"

namespace dts::device::bytes {
namespace {

using core::ErrorCode;

constexpr const char* kAccessHint =
    "serial ports belong to the group dialout: the unit of the service has SupplementaryGroups=dialout; for dtsd in a terminal, run "
    "\"sudo adduser $USER dialout\" and log in again";
constexpr const char* kPolicyHint =
    "the unit of the service allows ttyACM and ttyUSB only, and only if their drivers were loaded when it started: restart the service; "
    "for another kind of port, add its DeviceAllow= line with \"systemctl edit dtsd\"";
constexpr const char* kBusyHint = "close the other program (Arduino IDE, ModemManager, another rig) that uses it";

/// Identifies the node of a port: another plug-in makes a new one.
struct NodeIdentity {
  dev_t device = 0;
  dev_t port = 0;
  ino_t inode = 0;
  std::int64_t changed_ns = 0;
  friend bool operator==(const NodeIdentity&, const NodeIdentity&) = default;
};

std::optional<NodeIdentity> identity_of(const std::string& path) noexcept {
  struct stat found {};
  if (path.empty() || ::stat(path.c_str(), &found) != 0) return std::nullopt;
  return NodeIdentity{.device = found.st_dev,
                      .port = found.st_rdev,
                      .inode = found.st_ino,
                      .changed_ns = found.st_ctim.tv_sec * core::kNanosecondsPerSecond + found.st_ctim.tv_nsec};
}

core::Error open_error(int system_errno, const std::string& name) {
  const std::string what = "cannot open " + name + ": ";
  switch (system_errno) {
    case ENOENT: return {ErrorCode::NotFound, what + "there is no such port", "plug the board in; dtsctl device list shows the ports"};
    case ENODEV:
    case ENXIO:
    case EIO: return {ErrorCode::NotFound, what + "no device is behind it", "plug the board in again"};
    case EACCES: return {ErrorCode::NotAllowed, what + "no permission (EACCES)", kAccessHint};
    case EPERM: return {ErrorCode::NotAllowed, what + "the system forbids it (EPERM)", kPolicyHint};
    case EBUSY: return {ErrorCode::WrongState, what + "another program uses it", kBusyHint};
    default: return {ErrorCode::Failed, what + std::strerror(system_errno), "plug the board in again"};
  }
}

class SerialPort final : public DescriptorLink {
 public:
  SerialPort(std::string path, std::string usb_serial, std::uint32_t baud, core::Clock& clock, std::string sysfs_root)
      : DescriptorLink("serial port " + path, clock),
        path_(std::move(path)),
        usb_serial_(std::move(usb_serial)),
        sysfs_root_(std::move(sysfs_root)),
        baud_(baud) {}
  ~SerialPort() override { SerialPort::close(); }

  core::Status open() override {
    if (is_open()) return {};
    const Target target = find_target();
    seen_ = identity_of(target.path);
    if (target.path.empty() && !target.usb_serial.empty()) {
      return core::fail(
          ErrorCode::NotFound,
          "cannot open " + name() + ": it has the USB serial number " + target.usb_serial + ", the address says serial=" + usb_serial_,
          "plug in the right board, or correct serial; if this is the number that the board itself says, write the port as "
          "its link of /dev/serial/by-id");
    }
    if (target.path.empty()) {
      return core::fail(ErrorCode::NotFound,
                        "cannot open " + name() + ": it does not exist" +
                            (usb_serial_.empty() ? std::string{} : ", and no port has the USB serial number " + usb_serial_),
                        "plug the board in; dtsctl device list shows the ports");
    }
    const std::string shown = target.path == path_ ? name() : name() + " (now " + target.path + ")";
    core::Descriptor tty(::open(target.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (tty.get() < 0) return tl::make_unexpected(open_error(errno, shown));
    if (::isatty(tty.get()) == 0)
      return core::fail(ErrorCode::InvalidArgument, shown + " is not a serial port", "write a port that dtsctl device list shows");
    if (::flock(tty.get(), LOCK_EX | LOCK_NB) != 0) return tl::make_unexpected(open_error(errno == EWOULDBLOCK ? EBUSY : errno, shown));
    if (::ioctl(tty.get(), TIOCEXCL) != 0) return tl::make_unexpected(open_error(errno, shown));
    if (auto ready = set_up(tty.get(), shown); !ready) {
      static_cast<void>(::ioctl(tty.get(), TIOCNXCL));
      return ready;
    }
    {
      const std::lock_guard lock(facts_mutex_);
      facts_ = {.nodes = {real_path(target.path)}, .serial = target.usb_serial};
    }
    attach({.in = std::move(tty)});
    return {};
  }

  void close() noexcept override {
    if (!is_open()) return;
    discard_waiting_bytes(in());  // else the system waits up to 30 s for a board that takes no bytes
    // The kernel keeps the flag as long as a pseudo-terminal exists: the next program could not open it.
    static_cast<void>(::ioctl(in(), TIOCNXCL));
    detach();
    const std::lock_guard lock(facts_mutex_);
    facts_ = {};
  }

  bool has_arrived() noexcept override {
    std::optional<NodeIdentity> found;
    try {
      found = identity_of(usb_serial_.empty() ? path_ : find_target().path);
    } catch (const std::exception&) {  // no memory: the next call looks again
      return false;
    }
    const auto before = std::exchange(seen_, found);
    return found.has_value() && found != before;
  }

  Facts facts() const override {
    const std::lock_guard lock(facts_mutex_);
    return facts_;
  }

  std::string why_lost() const override {
    const auto error = lost();
    if (!error) return {};
    const bool is_unplugged = *error == 0 || *error == EIO || *error == ENODEV || *error == ENXIO;
    return name() + (is_unplugged ? std::string(" was unplugged") : std::string(" failed: ") + std::strerror(*error));
  }

  /// DTR rises when the port is opened, and resets an Uno or a Nano. Whether this board is wired so is not known.
  bool restarts_the_board() const noexcept override { return true; }

 private:
  struct Target {
    std::string path;        ///< Empty: there is none.
    std::string usb_serial;  ///< With an empty path: the number of the other unit that is at `path_`.
  };

  static std::string real_path(const std::string& path) {
    std::error_code error;
    const auto real = std::filesystem::canonical(path, error);
    return error ? path : real.string();
  }

  /// Finds the port to open: one with the wanted USB serial number; else `path_`, because the number may be the board's own. But never a
  /// kernel name (ttyACM0) whose unit has another number: after a replug it may belong to another rig, and opening it resets the board.
  Target find_target() const {
    const bool exists = identity_of(path_).has_value();
    const std::vector<UsbTty> ttys = usb_ttys(sysfs_root_);
    const std::string own_name = std::filesystem::path(real_path(path_)).filename();
    const auto own = std::ranges::find(ttys, own_name, &UsbTty::name);
    const Target at_path{.path = exists ? path_ : std::string{}, .usb_serial = exists && own != ttys.end() ? own->serial : std::string{}};
    if (usb_serial_.empty() || at_path.usb_serial == usb_serial_) return at_path;
    const auto wanted = std::ranges::find(ttys, usb_serial_, &UsbTty::serial);
    if (wanted != ttys.end()) return {.path = sysfs_root_ + wanted->node(), .usb_serial = wanted->serial};
    const bool is_fixed = path_.find("/dev/serial/by-id/") != std::string::npos;  // the link's name has the unit's number
    return is_fixed || at_path.usb_serial.empty() ? at_path : Target{.path = {}, .usb_serial = at_path.usb_serial};
  }

  core::Status set_up(int tty, const std::string& shown) const {
    if (const int error = set_raw_mode(tty, baud_); error != 0) return core::fail_errno(error, "cannot set up " + shown);
    const std::uint32_t actual = baud_of(tty);
    if (actual < baud_ - baud_ / 32 || actual > baud_ + baud_ / 32) {  // 3 %: beyond it, the 10th bit of a byte is read wrong
      return core::fail(ErrorCode::InvalidArgument,
                        shown + " cannot run at " + std::to_string(baud_) + " baud; the nearest is " + std::to_string(actual),
                        "choose another baud= on both sides");
    }
    request_low_latency(tty);
    discard_waiting_bytes(tty);
    return {};
  }

  std::string path_;
  std::string usb_serial_;
  std::string sysfs_root_;
  std::uint32_t baud_;
  std::optional<NodeIdentity> seen_;
  mutable std::mutex facts_mutex_;
  Facts facts_;
};

}  // namespace

std::unique_ptr<ByteLink> create_serial_port(std::string path, std::string usb_serial, std::uint32_t baud, core::Clock& clock,
                                             std::string sysfs_root) {
  return std::make_unique<SerialPort>(std::move(path), std::move(usb_serial), baud, clock, std::move(sysfs_root));
}

}  // namespace dts::device::bytes
