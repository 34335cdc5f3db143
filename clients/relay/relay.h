// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/clock.h"
#include "core/log.h"
#include "core/result.h"
#include "relay/settings.h"

namespace dts::relay {

/// Serves other machines until SIGTERM or SIGINT, which the caller must have blocked. `settings.network` must be set. Fails if the keys
/// cannot be read or an address cannot be bound.
[[nodiscard]] core::Status run_relay(const Settings& settings, core::Clock& clock, const core::Log& log);

}  // namespace dts::relay
