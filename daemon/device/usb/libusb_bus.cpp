// SPDX-License-Identifier: Apache-2.0
#include "device/usb/libusb_bus.h"

#include <fcntl.h>
#include <libusb-1.0/libusb.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <mutex>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "device/usb/libusb_error.h"
#include "device/usb/libusb_port.h"

namespace dts::device::usb {
namespace {

using core::ErrorCode;

constexpr int kStringTimeoutMs = 250;
constexpr std::size_t kDeepestHub = 7;  // USB 3.0 specification: levels between the root and a device

/// Owns the list of libusb_get_device_list; a device that is used longer needs its own reference.
class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) : count_(libusb_get_device_list(context, &devices_)) {}
  ~DeviceList() {
    if (count_ >= 0) libusb_free_device_list(devices_, 1);
  }
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;

  [[nodiscard]] ssize_t error() const noexcept { return std::min<ssize_t>(count_, 0); }
  [[nodiscard]] std::span<libusb_device* const> devices() const noexcept {
    return {devices_, static_cast<std::size_t>(std::max<ssize_t>(count_, 0))};
  }

 private:
  libusb_device** devices_ = nullptr;
  ssize_t count_;
};

/// Returns the unit as in its descriptors, without the serial number.
UsbUnit identity_of(libusb_device* device, const libusb_device_descriptor& descriptor) {
  UsbUnit unit;
  unit.vendor = descriptor.idVendor;
  unit.product = descriptor.idProduct;
  unit.release_bcd = descriptor.bcdDevice;
  unit.bus = libusb_get_bus_number(device);
  unit.address = libusb_get_device_address(device);
  return unit;
}

/// Returns the serial number that the kernel read when the device was plugged in: "/sys/bus/usb/devices/1-2.3/serial".
std::string serial_in_sysfs(libusb_device* device) {
  std::array<std::uint8_t, kDeepestHub> ports{};
  const int depth = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  if (depth <= 0) return {};
  std::string path = "/sys/bus/usb/devices/" + std::to_string(libusb_get_bus_number(device)) + "-";
  for (int i = 0; i < depth; ++i) path += (i == 0 ? "" : ".") + std::to_string(ports[static_cast<std::size_t>(i)]);
  std::string serial;
  std::getline(std::ifstream(path + "/serial"), serial);
  return serial;
}

std::string serial_by_opening(libusb_device* device, std::uint8_t index) {
  libusb_device_handle* opened = nullptr;
  if (libusb_open(device, &opened) != 0) return {};
  return LibusbHandle(opened).string_descriptor(index, kStringTimeoutMs);
}

/// Returns the errno of open(2) on the device file; 0: no error.
int errno_of_opening(const UsbUnit& unit) {
  const int node = ::open(unit.node().c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
  if (node < 0) return errno;
  ::close(node);
  return 0;
}

}  // namespace

struct LibusbBus::State {
  State(core::Clock& the_clock, core::ThreadPolicy the_policy, core::Log the_log)
      : clock(the_clock), policy(std::move(the_policy)), log(std::move(the_log)) {}

  [[nodiscard]] core::Status begin();
  void handle_events();
  static int on_arrival(libusb_context* context, libusb_device* device, libusb_hotplug_event event, void* state);

  core::Clock& clock;
  core::ThreadPolicy policy;
  core::Log log;
  std::mutex mutex;  ///< Only control threads lock it, never the event thread.
  libusb_context* context = nullptr;
  std::atomic<bool> is_ending{false};
  std::atomic<std::uint64_t> arrivals{0};
  std::atomic<int> open_ports{0};
  std::thread event_thread;
};

core::Status LibusbBus::State::begin() {
  const std::lock_guard lock(mutex);
  if (context != nullptr) return {};
  if (const int error = libusb_init(&context); error != 0) {
    context = nullptr;
    return core::fail(ErrorCode::Failed, std::string("cannot use USB: ") + libusb_strerror(error),
                      "check that /dev/bus/usb exists and that this process may use netlink sockets");
  }
  // `units` lists the devices that are already plugged in; the callback counts new ones.
  if (const int error =
          libusb_hotplug_register_callback(context, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, 0, LIBUSB_HOTPLUG_MATCH_ANY,
                                           LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, &State::on_arrival, this, nullptr);
      error != 0) {
    log.warning(std::string("dtsd notices newly plugged-in USB devices only after a delay: ") + libusb_strerror(error));
  }
  event_thread = std::thread([this] { handle_events(); });
  return {};
}

void LibusbBus::State::handle_events() {
  for (const std::string& refused : core::configure_this_thread("usb-events", policy)) log.warning(refused);
  int logged = 0;                                       // a lasting error is logged once
  while (!is_ending.load(std::memory_order_acquire)) {  // pairs with ~LibusbBus
    timeval longest{.tv_sec = 60, .tv_usec = 0};        // only an upper limit: events and ~LibusbBus wake libusb earlier
    const int error = libusb_handle_events_timeout_completed(context, &longest, nullptr);
    if (error == LIBUSB_ERROR_INTERRUPTED) continue;
    if (error != 0 && error != logged) log.error(std::string("cannot process USB events: ") + libusb_strerror(error));
    logged = error;
    if (error == 0) continue;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));  // a lasting error must not load a whole core
  }
}

int LibusbBus::State::on_arrival(libusb_context*, libusb_device*, libusb_hotplug_event, void* state) {
  static_cast<State*>(state)->arrivals.fetch_add(1, std::memory_order_release);  // pairs with LibusbBus::arrivals
  return 0;
}

LibusbBus::LibusbBus(core::Clock& clock, core::ThreadPolicy policy, core::Log log)
    : state_(std::make_unique<State>(clock, std::move(policy), std::move(log))) {}

LibusbBus::~LibusbBus() {
  if (state_->context == nullptr) return;
  state_->is_ending.store(true, std::memory_order_release);  // pairs with handle_events
  libusb_interrupt_event_handler(state_->context);
  state_->event_thread.join();
  if (state_->open_ports.load(std::memory_order_acquire) == 0) {  // pairs with open
    libusb_exit(state_->context);
    return;
  }
  state_->log.error("USB ports are still open at the end; libusb is not shut down");
  static_cast<void>(state_.release());  // the ports still refer to it
}

core::Result<std::vector<UsbUnit>> LibusbBus::units(std::span<const UsbModel> models) {
  DTS_TRY(state_->begin());
  const DeviceList list(state_->context);
  if (list.error() != 0)
    return core::fail(ErrorCode::Failed, std::string("cannot list USB devices: ") + libusb_strerror(static_cast<int>(list.error())));
  std::vector<UsbUnit> units;
  for (libusb_device* device : list.devices()) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != 0) continue;
    UsbUnit unit = identity_of(device, descriptor);
    const bool is_known = std::any_of(models.begin(), models.end(),
                                      [&](const UsbModel& model) { return model.vendor == unit.vendor && model.product == unit.product; });
    if (!is_known) continue;
    unit.serial = serial_in_sysfs(device);
    if (unit.serial.empty() && descriptor.iSerialNumber != 0) unit.serial = serial_by_opening(device, descriptor.iSerialNumber);
    units.push_back(std::move(unit));
  }
  std::sort(units.begin(), units.end(),
            [](const UsbUnit& a, const UsbUnit& b) { return std::pair(a.bus, a.address) < std::pair(b.bus, b.address); });
  return units;
}

core::Result<std::unique_ptr<UsbPort>> LibusbBus::open(const UsbUnit& unit) {
  DTS_TRY(state_->begin());
  const DeviceList list(state_->context);
  const auto devices = list.devices();
  const auto device = std::find_if(devices.begin(), devices.end(), [&](libusb_device* candidate) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(candidate, &descriptor) != 0) return false;
    const UsbUnit found = identity_of(candidate, descriptor);
    return found.vendor == unit.vendor && found.product == unit.product && found.bus == unit.bus && found.address == unit.address;
  });
  if (device == devices.end()) return tl::make_unexpected(open_error(LIBUSB_ERROR_NO_DEVICE, 0, unit));
  libusb_device_handle* opened = nullptr;
  if (const int error = libusb_open(*device, &opened); error != 0)
    return tl::make_unexpected(open_error(error, errno_of_opening(unit), unit));
  std::unique_ptr<LibusbPort> port;
  try {
    port = std::make_unique<LibusbPort>(unit, *device, opened, state_->clock, state_->log, [state = state_.get()] {
      state->open_ports.fetch_sub(1, std::memory_order_release);  // pairs with ~LibusbBus
    });
  } catch (const std::system_error& error) {  // the callers may not throw: they run on the thread of a rig
    return core::fail_errno(error.code().value(), "cannot open " + name_of(unit), "end clients that are not needed");
  }
  state_->open_ports.fetch_add(1, std::memory_order_relaxed);
  DTS_TRY(port->claim());
  return port;
}

std::uint64_t LibusbBus::arrivals() const noexcept {
  return state_->arrivals.load(std::memory_order_acquire);  // pairs with on_arrival
}

}  // namespace dts::device::usb
