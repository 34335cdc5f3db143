// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dts::app {

/// Reports the daemon's state to systemd (sd_notify(3)). Without systemd every call does nothing.
class ServiceManager {
 public:
  ServiceManager();

  void ready(const std::string& status);
  void stopping();
  void reloading(std::int64_t monotonic_ns);
  /// Returns true if half of the watchdog's time has passed since the last keep-alive; false if systemd's watchdog is off.
  [[nodiscard]] bool is_keep_alive_due(std::int64_t now_ns) const noexcept;
  void keep_alive(std::int64_t now_ns);

 private:
  std::int64_t watchdog_ns_ = 0;  ///< 0: the watchdog is off.
  std::int64_t last_alive_ns_ = 0;
};

}  // namespace dts::app
