// SPDX-License-Identifier: Apache-2.0
// The supervisor's work with devices: their test, connected devices, the sync pulse.
#include <algorithm>
#include <utility>

#include "device/registry.h"
#include "session/session_events.h"
#include "session/supervisor.h"

namespace dts::session {
namespace {

constexpr std::int64_t kSyncRetryNs = 1'000'000'000;

/// Returns whether the rig has opened this unit or port, or would open it.
template <class Found>
bool uses(const Rig& rig, const Found& unit, const std::string& node) {
  const std::vector<std::string> nodes = rig.device_report().nodes;
  if (!nodes.empty()) return std::ranges::find(nodes, node) != nodes.end();
  return device::is_meant_by(unit, rig.config().device_uri);
}

}  // namespace

core::Result<DeviceTest> Supervisor::test_device(const std::string& rig) {
  DTS_TRY_ASSIGN(auto entry, find(rig));
  const AcquisitionReport& acquisition = entry->rig->acquisition();
  DeviceTest test{.rig = entry->rig.get(), .statistics = {}, .report = entry->rig->device_report(), .problem = {}};
  if (acquisition.device != device::DeviceState::Streaming || acquisition.is_armed) {
    test.problem = acquisition.text();
    if (!test.report.checks.empty()) return test;  // the checks show what failed
    return core::fail(core::ErrorCode::DeviceGone, "rig '" + rig + "' is not streaming: " + test.problem);
  }
  test.statistics = entry->rig->statistics();
  if (test.statistics.scans > 0) return test;
  return core::fail(core::ErrorCode::WrongState, "rig '" + rig + "' has not streamed for a second yet", "try again");
}

std::vector<std::string> Supervisor::device_kinds() {
  std::vector<std::string> kinds;
  for (const device::RegistryEntry& entry : device::registry()) kinds.push_back(entry.scheme_and_name + "  " + entry.sentence);
  return kinds;
}

/// Signals the start of a session to other instruments: they record the sync line, or it is looped back into an input of the scan. Waits
/// for the first scan, so that the pulse is in the data. A pulse train continues from there until the session ends: it shows how the clocks
/// of the instruments drift.
void Supervisor::begin_sync_pulse(Entry& entry, std::int64_t now_ns) {
  const bool has_scans = entry.session.view(now_ns).state != SessionState::Starting;
  if (!entry.has_pulse_due || !has_scans || now_ns < entry.next_pulse_ns) return;
  const pipeline::RigConfig& config = entry.rig->config();
  const auto every_ns = static_cast<std::int64_t>(config.sync_pulse_every_ms * core::kNanosecondsPerMillisecond);
  entry.has_pulse_due = every_ns > 0 && entry.session.is_under_way();
  if (!entry.session.is_under_way()) return;
  if (every_ns > 0) {  // a late call delays one pulse, not those after it
    const std::int64_t due_ns = entry.next_pulse_ns == 0 ? now_ns : entry.next_pulse_ns;
    entry.next_pulse_ns = due_ns + every_ns * ((now_ns - due_ns) / every_ns + 1);
  }
  if (auto risen = entry.rig->set_sync_output(true); !risen) {
    if (std::exchange(entry.has_pulse_failed, true)) return;  // one report for all pulses that a device misses while it is away
    const std::string message = "no sync pulse: " + core::to_string(risen.error());
    log_.warning("rig '" + config.name + "': " + message);
    report_event(config.name, position_of(*entry.rig), device_event(entry.reported_state, config.device_uri, message));
    return;
  }
  entry.has_pulse_failed = false;
  entry.sync_low_at_ns = now_ns + static_cast<std::int64_t>(config.sync_pulse_ms * core::kNanosecondsPerMillisecond);
}

void Supervisor::end_sync_pulse(Entry& entry, std::int64_t now_ns) {
  if (entry.sync_low_at_ns == 0 || now_ns < entry.sync_low_at_ns) return;
  entry.sync_low_at_ns = 0;
  const auto fallen = entry.rig->set_sync_output(false);
  if (fallen) return;
  log_.warning("rig '" + entry.rig->config().name + "': the sync pulse did not end: " + core::to_string(fallen.error()));
  // Retries: a line that stays high would have no edge at the next session. Does not retry if the device is away, because it loses its
  // outputs.
  const bool is_there = fallen.error().code != core::ErrorCode::DeviceGone && entry.reported_state != device::DeviceState::Closed;
  if (is_there) entry.sync_low_at_ns = now_ns + kSyncRetryNs;
}

core::Result<std::vector<device::FoundUnit>> Supervisor::unused_units() {
  if (usb_ == nullptr) return std::vector<device::FoundUnit>{};
  DTS_TRY_ASSIGN(auto found, device::find_units(*usb_));
  std::erase_if(found, [&](const device::FoundUnit& candidate) {
    return std::ranges::any_of(entries_, [&](const auto& entry) { return uses(*entry.second.rig, candidate, candidate.unit.node()); });
  });
  return found;
}

std::vector<device::FoundPort> Supervisor::unused_ports() {
  if (!services_.ports_root) return {};
  std::vector<device::FoundPort> found = device::find_ports(*services_.ports_root);
  std::erase_if(found, [&](const device::FoundPort& candidate) {
    return std::ranges::any_of(entries_, [&](const auto& entry) { return uses(*entry.second.rig, candidate, candidate.tty.node()); });
  });
  return found;
}

}  // namespace dts::session
