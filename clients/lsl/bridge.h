// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/clock.h"
#include "core/log.h"
#include "core/result.h"
#include "dts/endpoints.h"
#include "lsl/liblsl.h"
#include "lsl/settings.h"

namespace dts::lsl {

/// Offers dtsd's streams and events in LSL until SIGTERM or SIGINT, which the caller must have blocked. A daemon that does not run, or that
/// restarts, is no failure: the outlets stay. Fails if LSL does not accept a predicate of the settings.
[[nodiscard]] core::Status run_bridge(const Settings& settings, const client::Endpoints& endpoints, const Liblsl& lsl, core::Clock& clock,
                                      const core::Log& log);

}  // namespace dts::lsl
