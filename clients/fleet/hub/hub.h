// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/clock.h"
#include "core/log.h"
#include "core/result.h"
#include "fleet/hub/settings.h"

namespace dts::fleet::hub {

/// Serves the clinics until SIGTERM or SIGINT, which the caller must have blocked. Works without PostgreSQL and nats-server for a time:
/// they may start later. Fails if a key, a folder or an address cannot be used.
[[nodiscard]] core::Status run_hub(const Settings& settings, core::Clock& clock, const core::Log& log);

}  // namespace dts::fleet::hub
