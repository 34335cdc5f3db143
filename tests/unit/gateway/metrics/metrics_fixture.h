// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <string>

#include "gateway/metrics/metrics.h"
#include "unit/libdts/fake_daemon.h"

namespace dts::gateway {

/// A daemon about which there is something to say in every metric.
inline v1::StatusSnapshot eventful_status() {
  v1::StatusSnapshot status = testing::floor_status();
  status.set_rejected_requests_total(2);
  status.set_has_network(true);
  status.add_notices("SCHED_FIFO rejected");
  status.mutable_disk()->set_state(v1::DISK_STATE_LOW);
  status.mutable_disk()->set_free_bytes(5'000'000'000);
  status.mutable_disk()->set_recordable_s(1800.5);
  v1::RigStatus& rig = *status.mutable_rigs(0);
  rig.set_scans_total(123'456'789);
  rig.set_reconnects_total(1);
  rig.set_restarts_total(4);
  rig.set_dropped_blocks_total(5);
  rig.set_lost_events_total(6);
  rig.set_pipeline_us_per_scan(12.5);
  rig.set_clock_drift_ppm(-25.0);
  rig.set_host_time_uncertainty_ns(1'500'000);
  v1::LossCount& loss = *rig.add_losses();
  loss.set_reason(v1::GAP_REASON_RING_FULL);
  loss.set_gaps_total(2);
  loss.set_lost_scans_total(150);
  rig.mutable_ring_fill()->set_frames_percent(25.0);
  rig.mutable_ring_fill()->set_record_percent(1.5);
  for (const auto& [upper_ms, blocks] : {std::pair{0.1, 0U}, {5.0, 90U}, {std::numeric_limits<double>::infinity(), 100U}}) {
    v1::LatencyHistogram::Bucket& bucket = *rig.mutable_latency()->add_buckets();
    bucket.set_upper_ms(upper_ms);
    bucket.set_blocks_total(blocks);
  }
  rig.mutable_latency()->set_sum_ms(750.0);
  rig.set_record_lag_s(0.5);
  v1::SessionInfo& session = *rig.mutable_session();
  session.set_session_id("20260131T120000Z-floor-1");
  session.set_subject("P007");
  session.set_label("after lunch");
  session.set_state(v1::SESSION_STATE_RUNNING);
  session.mutable_recording()->set_is_recording(true);
  session.mutable_recording()->set_bytes(4096);
  session.mutable_recording()->set_lost_scans_total(7);
  session.mutable_recording()->set_file("/var/lib/dtsd/sessions/P007.xdf.part");
  return status;
}

inline CarriedPointer carried(const v1::StatusSnapshot& status) {
  return std::make_shared<Carried>(
      Carried{.topic = std::string(kStatusTopic), .kind = Carried::Kind::Status, .bytes = status.SerializeAsString(), .is_retained = true});
}

inline GatewayCounts some_counts() {
  return {.version = "1.2.3",
          .server = {.connections_total = 20,
                     .refused_connections_total = 1,
                     .refused_requests_total = 2,
                     .answers_total = {{200, 15}, {404, 3}},
                     .connections = 4,
                     .tabs = 3},
          .dropped = {.blocks = 8, .scans = 800, .events = 9},
          .refused_logins_total = 5};
}

}  // namespace dts::gateway
