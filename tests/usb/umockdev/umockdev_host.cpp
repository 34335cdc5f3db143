// SPDX-License-Identifier: Apache-2.0
#include "usb/umockdev/umockdev_host.h"

#include <glib.h>
#include <sys/stat.h>

#include <array>
#include <cstdio>
#include <stdexcept>
#include <utility>

namespace dts::emulator {
namespace {

std::string three_digits(int number) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%03d", number);
  return text.data();
}

std::string node_of(int address) { return "/dev/bus/usb/001/" + three_digits(address); }

std::string hex4(const std::vector<std::uint8_t>& device_descriptor, std::size_t at) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "%02x%02x\n", device_descriptor.at(at + 1), device_descriptor.at(at));
  return text.data();
}

std::string root_of(UMockdevTestbed* testbed) {
  char* root = umockdev_testbed_get_root_dir(testbed);
  std::string text = root;
  g_free(root);
  return text;
}

}  // namespace

UmockdevHost::UmockdevHost(Pace pace, const core::Clock* clock)
    : pace_(pace), clock_(clock == nullptr ? system_clock_ : *clock), testbed_(umockdev_testbed_new()), root_(root_of(testbed_.get())) {
  g_mkdir_with_parents((root_ + "/dev/bus/usb/001").c_str(), 0755);
  leavers_thread_ = std::thread([this] { serve_leavers(); });
}

UmockdevHost::~UmockdevHost() {
  {
    const std::lock_guard lock(leavers_mutex_);
    is_ending_ = true;
  }
  leavers_changed_.notify_all();
  leavers_thread_.join();
  {
    const std::lock_guard lock(mutex_);
    while (!plugged_.empty()) unplug_locked(*plugged_.begin()->first);
  }
  testbed_.reset();  // ends the thread that calls into the nodes
}

bool UmockdevHost::is_available() { return umockdev_in_mock_environment() == TRUE; }

void UmockdevHost::plug(EmulatedDevice& device) {
  const std::lock_guard lock(mutex_);
  if (!plugged_.contains(&device)) plug_locked(device);
}

void UmockdevHost::unplug(EmulatedDevice& device) {
  const std::lock_guard lock(mutex_);
  if (plugged_.contains(&device)) unplug_locked(device);
}

void UmockdevHost::suspend(EmulatedDevice& device) {
  const std::lock_guard lock(mutex_);
  if (!plugged_.contains(&device)) return;
  unplug_locked(device);
  plug_locked(device);
}

void UmockdevHost::plug_locked(EmulatedDevice& device) {
  const int port = ports_.try_emplace(&device, static_cast<int>(ports_.size()) + 1).first->second;
  Plugged& plugged = plugged_[&device];
  plugged.address = next_address_++;
  const std::string node = node_of(plugged.address);
  plugged.node = std::make_unique<UsbfsNode>(root_ + node, device, pace_, clock_, [this, &device] { ask_to_leave(device); });
  if (umockdev_testbed_attach_ioctl(testbed_.get(), node.c_str(), plugged.node->handler(), nullptr) == FALSE)
    throw std::runtime_error("umockdev takes no handler for " + node);
  plugged.syspath = add_to_sysfs(device.descriptors(), port, plugged.address);
}

/// The first "add" event, which umockdev sends by itself, is dropped by libusb
/// because DEVTYPE is not there yet; the second comes when everything is in
/// place. So nobody ever opens half a device.
std::string UmockdevHost::add_to_sysfs(const Descriptors& descriptors, int port, int address) {
  const std::string number = std::to_string(address) + "\n";
  const std::string serial = descriptors.device.at(16) == 0 || descriptors.strings.size() < descriptors.device.at(16)
                                 ? ""
                                 : descriptors.strings.at(descriptors.device.at(16) - 1U) + "\n";
  const std::string vendor = hex4(descriptors.device, 8);
  const std::string product = hex4(descriptors.device, 10);
  const std::string minor = std::to_string(address - 1);
  const std::string node = node_of(address);
  const std::string name = "1-" + std::to_string(port);
  std::vector<std::string> attributes = {
      "busnum",   "1\n",  "devnum",    number, "bConfigurationValue", "1\n", "speed", descriptors.is_high_speed ? "480\n" : "12\n",
      "idVendor", vendor, "idProduct", product};
  if (!serial.empty() && !hides_serial) attributes.insert(attributes.end(), {"serial", serial});
  const std::vector<std::string> properties = {"BUSNUM", "001",   "DEVNUM", three_digits(address), "DEVNAME", node, "MAJOR",
                                               "189",    "MINOR", minor};
  const auto pointers = [](const std::vector<std::string>& texts) {
    std::vector<char*> list;
    for (const std::string& text : texts) list.push_back(const_cast<char*>(text.c_str()));
    list.push_back(nullptr);
    return list;
  };
  auto attribute_list = pointers(attributes);
  auto property_list = pointers(properties);
  char* added = umockdev_testbed_add_devicev(testbed_.get(), "usb", name.c_str(), nullptr, attribute_list.data(), property_list.data());
  if (added == nullptr) throw std::runtime_error("umockdev takes no device " + name);
  std::string syspath = added;
  g_free(added);
  std::vector<std::uint8_t> bytes = descriptors.device;
  bytes.insert(bytes.end(), descriptors.configuration.begin(), descriptors.configuration.end());
  umockdev_testbed_set_attribute_binary(testbed_.get(), syspath.c_str(), "descriptors", bytes.data(), static_cast<int>(bytes.size()));
  umockdev_testbed_set_property(testbed_.get(), syspath.c_str(), "DEVTYPE", "usb_device");
  umockdev_testbed_uevent(testbed_.get(), syspath.c_str(), "add");
  return syspath;
}

void UmockdevHost::unplug_locked(EmulatedDevice& device) {
  Plugged plugged = std::move(plugged_.at(&device));
  plugged_.erase(&device);
  plugged.node->pull();
  umockdev_testbed_uevent(testbed_.get(), plugged.syspath.c_str(), "remove");
  umockdev_testbed_remove_device(testbed_.get(), plugged.syspath.c_str());
  umockdev_testbed_detach_ioctl(testbed_.get(), node_of(plugged.address).c_str(), nullptr);
  pulled_.push_back(std::move(plugged.node));
}

std::shared_ptr<RunningDevice> UmockdevHost::running(EmulatedDevice& device) const {
  const std::lock_guard lock(mutex_);
  const auto plugged = plugged_.find(&device);
  return plugged == plugged_.end() ? nullptr : plugged->second.node->running();
}

void UmockdevHost::catch_up() const {
  const std::lock_guard lock(mutex_);
  for (const auto& [device, plugged] : plugged_) {
    if (const auto engine = plugged.node->running()) engine->catch_up();
  }
}

void UmockdevHost::end_transfers(EmulatedDevice& device, device::usb::UsbStatus status) {
  if (const auto engine = running(device)) engine->end_all(status);
}

void UmockdevHost::occupy(EmulatedDevice& device, bool is_occupied) {
  const std::lock_guard lock(mutex_);
  plugged_.at(&device).node->occupy(is_occupied);
}

std::size_t UmockdevHost::urbs_in_flight(EmulatedDevice& device) const {
  const std::lock_guard lock(mutex_);
  const auto plugged = plugged_.find(&device);
  return plugged == plugged_.end() ? 0 : plugged->second.node->urbs_in_flight();
}

/// The way to the socket must be free all the same: the preload library connects before it looks whether the node was opened, and
/// ends the process when it cannot.
void UmockdevHost::forbid(EmulatedDevice& device) const {
  const std::lock_guard lock(mutex_);
  const std::string node = node_of(plugged_.at(&device).address);
  const auto set_mode = [this](const std::string& path, mode_t mode) {
    if (::chmod((root_ + path).c_str(), mode) != 0) throw std::runtime_error("cannot change the mode of " + path);
  };
  set_mode("", 0755);
  set_mode("/ioctl" + node, 0777);
  set_mode(node, 0);
}

void UmockdevHost::locked(EmulatedDevice& device, const std::function<void()>& action) {
  const auto engine = running(device);
  if (engine == nullptr) return action();
  engine->locked([&] { action(); });
}

void UmockdevHost::ask_to_leave(EmulatedDevice& device) {
  {
    const std::lock_guard lock(leavers_mutex_);
    leavers_.push_back(&device);
  }
  leavers_changed_.notify_all();
}

void UmockdevHost::serve_leavers() {
  std::unique_lock lock(leavers_mutex_);
  while (true) {
    leavers_changed_.wait(lock, [this] { return is_ending_ || !leavers_.empty(); });
    if (is_ending_) return;
    EmulatedDevice& device = *leavers_.front();
    leavers_.pop_front();
    lock.unlock();
    suspend(device);
    lock.lock();
  }
}

}  // namespace dts::emulator
