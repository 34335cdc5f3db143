// SPDX-License-Identifier: Apache-2.0
#include "usb/fake/fake_bus.h"

#include <algorithm>
#include <string>
#include <utility>

#include "usb/fake/fake_port.h"

namespace dts::emulator {
namespace {

using device::usb::UsbUnit;

constexpr std::uint8_t kHighestAddress = 127;

std::uint16_t word_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  if (at + 1 >= bytes.size()) return 0;
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8U);
}

UsbUnit unit_of(const Descriptors& descriptors, std::uint8_t address) {
  UsbUnit unit{.vendor = word_at(descriptors.device, 8),
               .product = word_at(descriptors.device, 10),
               .release_bcd = word_at(descriptors.device, 12),
               .bus = 1,
               .address = address,
               .serial = {}};
  const std::size_t index = descriptors.device.size() > 16 ? descriptors.device[16] : 0;
  if (index > 0 && index <= descriptors.strings.size()) unit.serial = descriptors.strings[index - 1];
  return unit;
}

}  // namespace

FakeBus::~FakeBus() = default;

void FakeBus::plug(EmulatedDevice& device) {
  unplug(device);
  plugs_.push_back(std::make_shared<Plug>(Plug{device, unit_of(device.descriptors(), next_address_)}));
  next_address_ = next_address_ == kHighestAddress ? std::uint8_t{2} : static_cast<std::uint8_t>(next_address_ + 1);
  ++arrivals_;
  device.power_up(now_ns());
}

void FakeBus::unplug(EmulatedDevice& device) {
  std::erase_if(absent_, [&device](const Absent& absent) { return absent.device == &device; });
  for (const auto& plug : plugs_) {
    if (&plug->device != &device) continue;
    plug->is_gone = true;
    for (FakePort* port : ports_) {
      if (&port->plug() == plug.get()) port->lose();
    }
  }
  std::erase_if(plugs_, [](const auto& plug) { return plug->is_gone; });
}

void FakeBus::settle_plugs() {
  for (std::size_t i = 0; i < plugs_.size(); ++i) {
    EmulatedDevice& device = plugs_[i]->device;
    if (!device.wants_to_leave()) continue;
    unplug(device);
    absent_.push_back({&device, now_ns() + absence_ns});
    --i;
  }
  for (std::size_t i = 0; i < absent_.size(); ++i) {
    if (absent_[i].back_at_ns > now_ns()) continue;
    plug(*absent_[i].device);  // takes it out of the list
    --i;
  }
}

void FakeBus::settle() {
  for (bool has_moved = true; has_moved;) {
    settle_plugs();
    has_moved = false;
    for (FakePort* port : ports_) has_moved = port->advance(now_ns()) || has_moved;
  }
}

void FakeBus::step(std::int64_t deadline_ns) {
  settle();
  std::int64_t next_ns = deadline_ns;
  for (const FakePort* port : ports_) next_ns = std::min(next_ns, port->next_event_ns(now_ns()));
  for (const Absent& absent : absent_) next_ns = std::min(next_ns, absent.back_at_ns);
  clock_.sleep_until_ns(clock_.now_ns() + std::max<std::int64_t>(next_ns - now_ns(), 0));
  settle();
}

void FakeBus::run_until(std::int64_t time_ns) {
  settle();
  while (clock_.now_ns() < time_ns) step(raw_of(time_ns));
}

void FakeBus::spend(std::int64_t time_ns) {
  if (on_request) on_request(requests_);
  ++requests_;
  run_until(clock_.now_ns() + time_ns);
}

bool FakeBus::accepts_submit() noexcept {
  if (submits_until_refusal == 0) refuses_submit = true;
  if (!refuses_submit && submits_until_refusal != std::numeric_limits<std::uint64_t>::max()) --submits_until_refusal;
  return !refuses_submit;
}

int FakeBus::transfers_in_flight() const {
  int count = abandoned_transfers_;
  for (const FakePort* port : ports_) count += port->in_flight();
  return count;
}

int FakeBus::open_ports() const { return static_cast<int>(ports_.size()); }

std::uint64_t FakeBus::arrivals() const noexcept {
  // Those that are back by now but that nobody has settled yet count, too.
  const auto back = std::count_if(absent_.begin(), absent_.end(), [this](const Absent& absent) { return absent.back_at_ns <= now_ns(); });
  return arrivals_ + static_cast<std::uint64_t>(back);
}

core::Result<std::vector<UsbUnit>> FakeBus::units(std::span<const device::usb::UsbModel> models) {
  settle();
  std::vector<UsbUnit> found;
  for (const auto& plug : plugs_) {
    const bool is_known = std::any_of(models.begin(), models.end(), [&plug](const device::usb::UsbModel& model) {
      return model.vendor == plug->unit.vendor && model.product == plug->unit.product;
    });
    if (is_known) found.push_back(plug->unit);
  }
  std::sort(found.begin(), found.end(), [](const UsbUnit& a, const UsbUnit& b) { return a.address < b.address; });
  return found;
}

core::Result<std::unique_ptr<device::usb::UsbPort>> FakeBus::open(const UsbUnit& unit) {
  settle();
  const auto found = std::find_if(plugs_.begin(), plugs_.end(), [&unit](const auto& plug) { return plug->unit.address == unit.address; });
  if (found == plugs_.end()) return core::fail(core::ErrorCode::DeviceGone, unit.node() + " is gone");
  if (is_forbidden) return core::fail(core::ErrorCode::NotAllowed, unit.node() + ": permission denied", "install the udev rule");
  if (is_busy || (*found)->is_claimed) return core::fail(core::ErrorCode::WrongState, unit.node() + ": another program has it");
  return std::make_unique<FakePort>(*this, *found);
}

}  // namespace dts::emulator
