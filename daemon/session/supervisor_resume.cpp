// SPDX-License-Identifier: Apache-2.0
// How the supervisor resumes sessions after a crash.
#include <algorithm>
#include <vector>

#include "session/supervisor.h"

namespace dts::session {
namespace {

constexpr std::int64_t kTryForNs = 60'000'000'000;  // for a device that is found late; later, the operator decides
constexpr std::int64_t kTryEveryNs = 1'000'000'000;

}  // namespace

void Supervisor::resume_interrupted() {
  resumable_ = services_.recordings.take_resumable();
  resume_until_ns_ = clock_.now_ns() + kTryForNs;
}

void Supervisor::forget_resumable(const std::string& rig) {
  std::erase_if(resumable_, [&](const std::string& id) {
    const auto row = services_.recordings.catalogue().session(id);
    if (!row) return true;
    const std::vector<std::string> rigs = rigs_of(*row, facts_of(*row));
    return std::ranges::find(rigs, rig) != rigs.end();
  });
}

/// Returns whether a rig of the session has no scans yet but may have some soon: a session without scans would begin empty.
bool Supervisor::waits_for_device(const std::string& session_id, std::int64_t now_ns) {
  if (now_ns >= resume_until_ns_) return false;
  const auto row = services_.recordings.catalogue().session(session_id);
  const auto entries = row ? find_all(rigs_of(*row, facts_of(*row))) : tl::make_unexpected(row.error());
  return entries && std::ranges::any_of(*entries, [](Entry* entry) { return entry->rig->acquisition().scans_total == 0; });
}

void Supervisor::try_resumes(std::int64_t now_ns) {
  if (resumable_.empty() || now_ns < next_resume_ns_) return;
  next_resume_ns_ = now_ns + kTryEveryNs;
  for (const std::string& id : std::vector(resumable_)) {  // a copy, because a resumed session is removed from the list
    if (waits_for_device(id, now_ns)) continue;
    const auto resumed = resume_session(id);
    if (resumed) {
      log_.warning("session " + id + " was interrupted; dtsd resumed it");
      services_.recordings.enter_audit(
          {.utc_ns = now_ns + clock_.utc_minus_monotonic_ns(), .who = "dtsd", .what = "resume_session", .target = id, .result = "ok"});
      continue;
    }
    const bool may_work_later = resumed.error().code == core::ErrorCode::WrongState && now_ns < resume_until_ns_;
    if (may_work_later) continue;
    log_.error("session " + id + " was interrupted, and dtsd cannot resume it: " + core::to_string(resumed.error()));
    std::erase(resumable_, id);
  }
}

}  // namespace dts::session
