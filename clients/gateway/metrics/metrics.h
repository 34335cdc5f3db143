// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "gateway/bus/carried.h"
#include "gateway/bus/tab_queue.h"
#include "gateway/http/server.h"

namespace dts::gateway {

/// The gateway's own counters.
struct GatewayCounts {
  std::string version;
  ServerStatistics server;
  TabQueue::Dropped dropped;  ///< Sum over all tabs, including closed ones.
  std::uint64_t refused_logins_total = 0;
};

/// Returns the body of GET /metrics: the daemon's last status and the gateway's counters. `status`: nullptr if the daemon is silent; dts_up
/// is then 0 and all other metrics of the daemon are absent.
[[nodiscard]] std::string metrics_text(const CarriedPointer& status, const GatewayCounts& counts);

}  // namespace dts::gateway
