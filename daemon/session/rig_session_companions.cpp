// SPDX-License-Identifier: Apache-2.0
// Sessions over several rigs: how companions end, and what is reported of a rig that is lost.
#include <algorithm>
#include <utility>

#include "session/rig_session.h"

namespace dts::session {
namespace {

void add(std::string& list, const std::string& text) { list += (list.empty() ? "" : "; ") + text; }

}  // namespace

/// Ends the sessions of the companions. Their recordings end with that of this rig, so that they cover the same time.
void RigSession::stop_companions(const Moment& moment) {
  for (RigSession* companion : companions_) {
    companion->is_aborted_ = is_aborted_;
    companion->end_reason_ = end_reason_;
    static_cast<void>(companion->session_.stop(moment.now_ns));  // fails only if it is stopping already
    companion->collect(position_of(companion->rig_));
  }
}

/// Ends this companion's share of the session, whose recording is closed. If it failed, the session continues without it.
void RigSession::leave(const FinishedRecording& finished, const Moment& moment) {
  if (session_.view(moment.now_ns).state != SessionState::Stopping) {
    session_.fail(moment.now_ns, "the recording stopped: " + finished.incomplete);
  }
  end_recording(moment);
  session_.closed(moment.now_ns);
  collect(moment.at);
  RigSession& leader = *std::exchange(leader_, nullptr);
  std::erase(leader.companions_, this);
  leader.note_incomplete(rig(), finished);
  leader.close_if_all_ended(
      {.now_ns = moment.now_ns, .utc_minus_monotonic_ns = moment.utc_minus_monotonic_ns, .at = position_of(leader.rig_)});
}

/// Ends the session when the recordings of all its rigs are closed.
void RigSession::close_if_all_ended(const Moment& moment) {
  if (is_recording_ || !companions_.empty() || session_.view(moment.now_ns).state != SessionState::Stopping) return;
  session_.closed(moment.now_ns);
  collect(moment.at);
  enter_end(moment.now_ns);
}

/// Keeps why a recording of the session is not complete.
void RigSession::note_incomplete(const std::string& rig, const FinishedRecording& finished) {
  if (finished.incomplete.empty()) return;
  add(incomplete_, rigs_.empty() ? finished.incomplete : "rig '" + rig + "': " + finished.incomplete);
}

/// Reports which rigs of the session are lost: the others continue.
void RigSession::report_lost(std::int64_t now_ns) {
  if (rigs_.empty() || is_companion() || !session_.is_under_way()) return;
  if (session_.view(now_ns).state == SessionState::Stopping) return;
  std::string lost = incomplete_;
  std::vector<RigSession*> all{this};
  all.insert(all.end(), companions_.begin(), companions_.end());
  for (RigSession* one : all) {
    const AcquisitionReport& report = one->rig_.acquisition();
    if (report.delivers() || report.scans_total == 0) continue;
    add(lost, "rig '" + one->rig() + "' delivers nothing: " + std::string(report.text()));
    if (std::ranges::find(lost_rigs_, one->rig()) == lost_rigs_.end()) lost_rigs_.push_back(one->rig());
  }
  session_.report(now_ns, std::move(lost));
}

}  // namespace dts::session
