// SPDX-License-Identifier: Apache-2.0
#include "gateway/metrics/metrics.h"

#include "dts/v1/control.pb.h"
#include "gateway/metrics/daemon_metrics.h"
#include "gateway/metrics/exposition.h"

namespace dts::gateway {
namespace {

void add_gateway(const GatewayCounts& counts, Exposition& out) {
  const auto count = [&out](const Described& what, std::uint64_t value) { out.counter(what, static_cast<double>(value)); };
  out.gauge({"dts_gateway_info", "Version of the gateway, as a label."}, 1.0, {{"version", counts.version}});
  out.gauge({"dts_gateway_connections", "Open connections."}, static_cast<double>(counts.server.connections));
  out.gauge({"dts_gateway_tabs", "Connected browser tabs."}, static_cast<double>(counts.server.tabs));
  count({"dts_gateway_connections_total", "Connections opened."}, counts.server.connections_total);
  count({"dts_gateway_refused_connections_total", "Connections rejected by the limits."}, counts.server.refused_connections_total);
  count({"dts_gateway_refused_requests_total", "Requests rejected as malformed, too large, too slow, too many or from another site."},
        counts.server.refused_requests_total);
  for (const auto& [status, answers] : counts.server.answers_total) {
    out.counter({"dts_gateway_answers_total", "HTTP answers, by status."}, static_cast<double>(answers),
                {{"status", std::to_string(status)}});
  }
  count({"dts_gateway_refused_logins_total", "Rejected logins: wrong name or password, or too soon after one."},
        counts.refused_logins_total);
  count({"dts_gateway_dropped_blocks_total", "Blocks dropped because a tab was too slow."}, counts.dropped.blocks);
  count({"dts_gateway_dropped_scans_total", "Scans in those blocks."}, counts.dropped.scans);
  count({"dts_gateway_dropped_events_total", "Events dropped because a tab was too slow."}, counts.dropped.events);
}

}  // namespace

std::string metrics_text(const CarriedPointer& status, const GatewayCounts& counts) {
  Exposition out;
  v1::StatusSnapshot snapshot;
  const bool is_up = status != nullptr && snapshot.ParseFromString(status->bytes);
  out.gauge({"dts_up", "1 while the daemon answers; 0: no answer, and its other series are absent."}, is_up ? 1.0 : 0.0);
  add_gateway(counts, out);
  if (is_up) add_daemon(snapshot, out);
  return out.text();
}

}  // namespace dts::gateway
