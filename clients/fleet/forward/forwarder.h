// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/log.h"
#include "core/result.h"
#include "fleet/forward/settings.h"

namespace dts::fleet::forward {

/// Runs until SIGTERM or SIGINT, which the caller has blocked. Fails if the key or the state folder cannot be used, or if the options of
/// the connection are wrong. A centre or a daemon that does not answer is no failure.
///
///     watch   receives dtsd's status and session events; sends the beat
///     desk    asks dtsd what is new; sends facts and erasures
///     upload  reads and sends recordings; SCHED_IDLE, the lowest I/O priority
///     live    sends what is watched
///
/// Upload has a connection of its own, and so has what is watched, while somebody watches: neither recordings on a slow link nor a slow viewer
/// delay facts and beats.
[[nodiscard]] core::Status run_forwarder(const Settings& settings, const core::Log& log);

}  // namespace dts::fleet::forward
