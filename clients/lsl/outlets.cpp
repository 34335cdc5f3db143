// SPDX-License-Identifier: Apache-2.0
#include "lsl/outlets.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "lsl/event_text.h"
#include "lsl/hash_text.h"

namespace dts::lsl {
namespace {

constexpr std::int64_t kAgainNs = core::kNanosecondsPerSecond;

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "localhost";
  return name.data();
}

std::set<std::string, std::less<>> set_of(const std::vector<std::string>& texts) { return {texts.begin(), texts.end()}; }

/// Returns true for an event that dtsd repeats to every new subscriber, because it describes a state.
bool is_retained(const v1::Event& event) { return event.has_device() || event.has_session(); }

}  // namespace

Outlets::Outlets(const Settings& settings, const Liblsl& lsl, AskDevices ask_devices, core::Clock& clock, core::Log log)
    : rigs_(set_of(settings.rigs)),
      streams_(set_of(settings.streams)),
      buffer_s_(settings.buffer_s),
      lsl_(lsl),
      ask_devices_(std::move(ask_devices)),
      clock_(clock),
      log_(std::move(log)),
      host_(host_name()),
      opened_ns_(clock.now_ns()) {}

bool Outlets::is_wanted(std::string_view rig) const { return rigs_.empty() || rigs_.contains(rig); }

bool Outlets::is_wanted(const client::Block& block) const {
  return is_wanted(block.rig) && (streams_.empty() || streams_.contains(block.stream));
}

/// The serial number makes the ID the same after a restart and on another machine. A device without one is known by machine and address;
/// so is a simulated one, because every machine has the same. A command line or a file name is private: its hash stands for it.
std::string Outlets::source_id(const std::string& name, const Device& device) const {
  const bool has_own_number = !device.serial.empty() && !device.uri.starts_with("sim:") && !device.uri.starts_with("replay:");
  const bool is_private = device.uri.starts_with("exec:") || device.uri.starts_with("replay:");
  const std::string address = is_private ? device.uri.substr(0, device.uri.find(':') + 1) + hash_text(device.uri) : device.uri;
  const std::string origin = has_own_number ? device.serial : host_ + "/" + address;
  return kSourceIdPrefix + name + "/" + origin;
}

/// Returns nullptr if dtsd does not say which device it is; asks at most once a second.
const Outlets::Device* Outlets::device_of(std::string_view rig) {
  if (const auto known = devices_.find(rig); known != devices_.end()) return &known->second;
  const std::int64_t now_ns = clock_.now_ns();
  if (now_ns < next_question_ns_) return nullptr;
  const auto answer = ask_devices_();
  if (!answer) {
    next_question_ns_ = clock_.now_ns() + kAgainNs;
    log_.warning("the streams of rig " + std::string(rig) + " are not offered yet: " + answer.error().what);
    return nullptr;
  }
  for (const v1::DeviceInfo& device : answer->devices()) {
    if (!device.rig().empty()) devices_[device.rig()] = {.model = device.model(), .serial = device.serial(), .uri = device.uri()};
  }
  const auto found = devices_.try_emplace(std::string(rig)).first;  // a rig without a device has neither serial number nor address
  return &found->second;
}

/// Makes the outlet, or makes it again if dtsd's description of the stream has changed.
Outlet* Outlets::offer(OutletFacts facts) {
  const std::string name = facts.name;
  if (const auto known = outlets_.find(name); known != outlets_.end()) {
    if (known->second->facts() == facts) {
      checked_.insert(name);
      return known->second.get();
    }
    outlets_.erase(known);  // two outlets with one source_id would confuse recorders
  }
  if (clock_.now_ns() < next_offer_ns_) return nullptr;
  auto outlet = Outlet::create(lsl_, std::move(facts), buffer_s_);
  if (!outlet) {
    next_offer_ns_ = clock_.now_ns() + kAgainNs;
    log_.error(core::to_string(outlet.error()));
    return nullptr;
  }
  log_.info("the LSL stream " + name + " is offered");
  checked_.insert(name);
  return (outlets_[name] = std::move(*outlet)).get();
}

Outlet* Outlets::outlet_of(const client::Block& block) {
  if (checked_.contains(block.topic)) return outlets_.find(block.topic)->second.get();
  const Device* const device = device_of(block.rig);
  if (device == nullptr) return nullptr;
  const std::string name(block.topic);
  return offer({.name = name,
                .source_id = source_id(name, *device),
                .format = *block.format,
                .device_model = device->model,
                .device_serial = device->serial,
                .daemon_version = daemon_version_});
}

void Outlets::push_event(std::string_view rig, const std::string& text, std::int64_t host_ns) {
  if (!is_wanted(rig) || daemon_version_.empty()) return;  // the first status follows within a second
  const std::string name = std::string(rig) + "/events";
  const auto known = outlets_.find(name);
  Outlet* const outlet = known != outlets_.end() ? known->second.get()
                                                 : offer({.name = name,
                                                          .source_id = kSourceIdPrefix + name + "/" + host_,
                                                          .format = {},
                                                          .device_model = {},
                                                          .device_serial = {},
                                                          .daemon_version = daemon_version_});
  if (outlet != nullptr) outlet->push(text, host_ns);
}

void Outlets::take(const client::Block& block) {
  if (!is_wanted(block)) return;
  if (block.lost_scans > 0 || !block.is_lost_exact) push_event(block.rig, loss_text(block), block.host_time_ns);
  if (Outlet* const outlet = outlet_of(block); outlet != nullptr) outlet->push(block);
}

void Outlets::take(const client::Event& event) {
  const std::int64_t at_ns = event.body->has_host_time_ns() ? event.body->host_time_ns() : clock_.now_ns();
  const bool is_older = is_retained(*event.body) && at_ns < opened_ns_;
  if (is_offered(*event.body) && !is_older) push_event(event.rig, event_text(*event.body), at_ns);
  if (!event.body->has_device()) return;
  // The device may be another one when it streams again: its outlets are compared with the next blocks.
  if (const auto known = devices_.find(event.rig); known != devices_.end()) devices_.erase(known);
  const std::string rig = std::string(event.rig) + "/";
  std::erase_if(checked_, [&rig](const std::string& name) { return name.starts_with(rig); });
}

void Outlets::take(const v1::StatusSnapshot& status) {
  daemon_version_ = status.version();
  for (const v1::RigStatus& rig : status.rigs()) {
    const std::string name = rig.rig().name() + "/events";
    if (!is_wanted(rig.rig().name()) || checked_.contains(name)) continue;
    offer({.name = name,
           .source_id = kSourceIdPrefix + name + "/" + host_,
           .format = {},
           .device_model = {},
           .device_serial = {},
           .daemon_version = daemon_version_});
  }
}

void Outlets::take(const client::Restart& /*restart*/) {
  const std::int64_t now_ns = clock_.now_ns();
  for (const auto& [name, outlet] : outlets_) {
    if (!outlet->facts().format) outlet->push(restart_text(now_ns), now_ns);
  }
  devices_.clear();
  checked_.clear();
}

}  // namespace dts::lsl
