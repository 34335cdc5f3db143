// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/beat.h"

#include <algorithm>

namespace dts::fleet::forward {
namespace {

void add(const v1::RigStatus& rig, v1::RigBeat& out) {
  out.set_rig(rig.rig().name());
  out.set_kind(rig.rig().kind());
  out.set_device(rig.device());
  out.set_nominal_rate_hz(rig.nominal_rate_hz());
  if (rig.has_measured_rate_hz()) out.set_measured_rate_hz(rig.measured_rate_hz());
  out.set_scans_total(rig.scans_total());
  out.set_lost_scans_total(rig.lost_scans_total());
  out.set_gaps_total(rig.gaps_total());
  out.set_session(rig.session().state());
  out.set_session_id(rig.session().session_id());
  out.set_calibration(rig.rig().calibration());
  out.set_sensors(static_cast<std::uint32_t>(rig.rig().sensors_size()));
  for (const std::string& stream : rig.rig().published()) out.add_streams(stream);
}

}  // namespace

v1::Beat beat_of(const v1::StatusSnapshot* status, const v1::Backlog& backlog, const std::string& version, std::int64_t utc_ns) {
  v1::Beat beat;
  beat.set_utc_ns(utc_ns);
  beat.set_forwarder_version(version);
  *beat.mutable_backlog() = backlog;
  if (status == nullptr) return beat;
  beat.set_has_daemon(true);
  beat.set_daemon_version(status->version());
  for (const v1::RigStatus& rig : status->rigs()) add(rig, *beat.add_rigs());
  beat.mutable_disk()->set_state(status->disk().state());
  beat.mutable_disk()->set_free_bytes(status->disk().free_bytes());
  beat.mutable_disk()->set_recordable_s(status->disk().recordable_s());
  return beat;
}

bool is_session_running(const v1::StatusSnapshot& status) {
  return std::ranges::any_of(status.rigs(), [](const v1::RigStatus& rig) {
    const v1::SessionState state = rig.session().state();
    return state == v1::SESSION_STATE_STARTING || state == v1::SESSION_STATE_SETTLING || state == v1::SESSION_STATE_RUNNING ||
           state == v1::SESSION_STATE_STOPPING;
  });
}

}  // namespace dts::fleet::forward
