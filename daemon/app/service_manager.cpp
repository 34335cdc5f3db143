// SPDX-License-Identifier: Apache-2.0
#include "app/service_manager.h"

#include <systemd/sd-daemon.h>

namespace dts::app {

ServiceManager::ServiceManager() {
  std::uint64_t microseconds = 0;
  if (sd_watchdog_enabled(0, &microseconds) > 0) watchdog_ns_ = static_cast<std::int64_t>(microseconds) * 1000;
}

void ServiceManager::ready(const std::string& status) { sd_notifyf(0, "READY=1\nSTATUS=%s", status.c_str()); }

void ServiceManager::stopping() { sd_notify(0, "STOPPING=1"); }

void ServiceManager::reloading(std::int64_t monotonic_ns) {
  sd_notifyf(0, "RELOADING=1\nMONOTONIC_USEC=%lld", static_cast<long long>(monotonic_ns / 1000));
}

bool ServiceManager::is_keep_alive_due(std::int64_t now_ns) const noexcept {
  return watchdog_ns_ > 0 && now_ns - last_alive_ns_ >= watchdog_ns_ / 2;
}

void ServiceManager::keep_alive(std::int64_t now_ns) {
  sd_notify(0, "WATCHDOG=1");
  last_alive_ns_ = now_ns;
}

}  // namespace dts::app
