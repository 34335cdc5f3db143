// SPDX-License-Identifier: Apache-2.0
#include "app/progress_watch.h"

#include <algorithm>
#include <utility>

namespace dts::app {
namespace {

/// Returns a number that changes while the rig's thread runs: with scans, or while it waits for them or for room for them.
std::uint64_t signs_of_life(const session::AcquisitionReport& acquired) noexcept { return acquired.scans_total + acquired.turns; }

}  // namespace

bool ProgressWatch::is_stuck(const std::string& name, std::uint64_t mark, bool has_work, std::int64_t now_ns, std::int64_t patience_ns) {
  const auto [at, is_new] = parts_.try_emplace(name, Part{.mark = mark, .moved_ns = now_ns});
  Part& part = at->second;
  if (is_new || part.mark != mark || !has_work) part = {.mark = mark, .moved_ns = now_ns};
  return now_ns - part.moved_ns > patience_ns;
}

void ProgressWatch::find_hung_rigs(const std::vector<session::RigState>& rigs, std::int64_t now_ns) {
  const std::set<std::string> before = std::exchange(hung_rigs_, {});
  new_hangs_.clear();
  for (const session::RigState& state : rigs) {
    const std::string& name = state.rig.config().name;
    if (!is_stuck("opening " + name, signs_of_life(state.acquisition), true, now_ns, kOpeningNs)) continue;
    hung_rigs_.insert(name);
    if (before.contains(name)) continue;
    new_hangs_.push_back("rig '" + name + "': opening the device has not finished for " + std::to_string(kOpeningNs / 1'000'000'000) +
                         " s. Unplug the device and plug it in again; if that does not help, restart dtsd between two sessions");
  }
}

std::string ProgressWatch::stuck_part(const std::vector<session::RigState>& rigs, std::uint64_t publish_turns, std::int64_t now_ns) {
  // After a long time without a call (the machine or the whole process was suspended) the old marks prove nothing.
  if (now_ns - looked_ns_ > patience_ns_) parts_.clear();
  looked_ns_ = now_ns;
  std::string stuck;
  if (is_stuck("publish", publish_turns, true, now_ns, patience_ns_)) stuck = "the publish thread";
  find_hung_rigs(rigs, now_ns);
  const bool may_restart = std::ranges::none_of(rigs, [this](const session::RigState& state) {
    const session::SessionState session = state.session.state;
    const bool is_under_way = session != session::SessionState::Idle && session != session::SessionState::Failed;
    return is_under_way && !hung_rigs_.contains(state.rig.config().name);
  });
  for (const session::RigState& state : rigs) {
    const std::string rig = "rig '" + state.rig.config().name + "'";
    const session::AcquisitionReport& acquired = state.acquisition;
    const bool is_streaming = acquired.device == device::DeviceState::Streaming && !acquired.is_silent && !acquired.is_armed;
    const bool is_behind = state.pipeline.end.segment != acquired.segment || state.pipeline.next_scan.value != acquired.next_scan;
    // The mark changes with every scan. If two marks are equal by chance, the next call sees a different one.
    const std::uint64_t processed = (std::uint64_t{state.pipeline.end.segment} << 48U) ^ state.pipeline.next_scan.value;
    if (is_stuck("acquire " + rig, signs_of_life(acquired), is_streaming, now_ns, patience_ns_)) stuck = "the device of " + rig;
    if (may_restart && hung_rigs_.contains(state.rig.config().name)) stuck = "the device of " + rig + ", which is being opened,";
    if (is_stuck("pipeline " + rig, processed, is_streaming && is_behind, now_ns, patience_ns_)) stuck = "a stage of " + rig;
  }
  return stuck;
}

}  // namespace dts::app
