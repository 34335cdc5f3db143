// SPDX-License-Identifier: Apache-2.0
#include "app/progress_watch.h"

namespace dts::app {

bool ProgressWatch::is_stuck(const std::string& name, std::uint64_t mark, bool has_work, std::int64_t now_ns) {
  const auto [at, is_new] = parts_.try_emplace(name, Part{.mark = mark, .moved_ns = now_ns});
  Part& part = at->second;
  if (is_new || part.mark != mark || !has_work) part = {.mark = mark, .moved_ns = now_ns};
  return now_ns - part.moved_ns > patience_ns_;
}

std::string ProgressWatch::stuck_part(const std::vector<session::RigState>& rigs, std::uint64_t publish_turns, std::int64_t now_ns) {
  // Whoever did not look for long (the machine or the whole process stood still) knows nothing of what moved meanwhile.
  if (now_ns - looked_ns_ > patience_ns_) parts_.clear();
  looked_ns_ = now_ns;
  std::string stuck;
  if (is_stuck("publish", publish_turns, true, now_ns)) stuck = "the publish thread";
  for (const session::RigState& state : rigs) {
    const std::string rig = "rig '" + state.rig.config().name + "'";
    const session::AcquisitionReport& acquired = state.acquisition;
    const bool is_streaming = acquired.device == device::DeviceState::Streaming && !acquired.is_silent && !acquired.is_armed;
    const bool is_behind = state.pipeline.segment != acquired.segment || state.pipeline.next_scan.value != acquired.next_scan;
    // Both marks change with every scan: of two that meet by chance the next look sees another.
    const std::uint64_t processed = (std::uint64_t{state.pipeline.segment} << 48U) ^ state.pipeline.next_scan.value;
    if (is_stuck("acquire " + rig, acquired.scans_total, is_streaming, now_ns)) stuck = "the acquire thread of " + rig;
    if (is_stuck("pipeline " + rig, processed, is_streaming && is_behind, now_ns)) stuck = "the pipeline of " + rig;
  }
  return stuck;
}

}  // namespace dts::app
