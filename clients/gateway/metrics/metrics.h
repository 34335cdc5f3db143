// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "gateway/bus/carried.h"
#include "gateway/bus/tab_queue.h"
#include "gateway/http/server.h"

namespace dts::gateway {

/// What the gateway counts of itself.
struct GatewayCounts {
  std::string version;
  ServerStatistics server;
  TabQueue::Dropped dropped;  ///< For all tabs, also those that are closed.
  std::uint64_t refused_logins_total = 0;
};

/// The body of GET /metrics: what the daemon said last (`status`; nullptr: it is silent, then dts_up is 0 and all that is the daemon's is
/// absent) and what the gateway counts.
[[nodiscard]] std::string metrics_text(const CarriedPointer& status, const GatewayCounts& counts);

}  // namespace dts::gateway
