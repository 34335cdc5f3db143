// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "app/config.h"
#include "core/clock.h"
#include "core/doorbell.h"
#include "core/log.h"
#include "core/result.h"
#include "device/usb/usb_bus.h"
#include "session/rig.h"

namespace dts::app {

[[nodiscard]] std::string_view version() noexcept;

/// Creates every rig of the configuration without starting it, so that a wrong device or stage is found before a socket is bound. Does not
/// use USB. `log` gets the lines that programs of `exec:` write to stderr. Adds every error to `problems`.
[[nodiscard]] std::vector<std::unique_ptr<session::Rig>> create_rigs(const DaemonConfig& config, core::Clock& clock, core::Doorbell& bell,
                                                                     device::usb::UsbBus& usb, const core::Log& log,
                                                                     files::Problems& problems);

/// Runs the daemon on the calling thread, which becomes the control thread, until SIGTERM or SIGINT. The caller must have blocked SIGTERM,
/// SIGINT and SIGHUP. `notices` go to the log and to the status. Fails if the directories or sockets cannot be used.
[[nodiscard]] core::Status run_daemon(const DaemonConfig& config, std::vector<std::unique_ptr<session::Rig>> rigs,
                                      std::vector<std::string> notices, core::Clock& clock, core::Doorbell& bell, device::usb::UsbBus& usb,
                                      core::Log log);

}  // namespace dts::app
