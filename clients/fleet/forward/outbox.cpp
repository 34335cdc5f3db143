// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/outbox.h"

#include <algorithm>
#include <set>

#include "core/clock.h"

namespace dts::fleet::forward {
namespace {

constexpr std::uint32_t kNewest = 100;
/// The audit trail has the time at which an erasure began. dtsd may have listed its sessions a little longer.
constexpr std::int64_t kLongestErasureNs = 60 * core::kNanosecondsPerSecond;

constexpr std::int64_t kAskAgainNs = 3600 * core::kNanosecondsPerSecond;

bool is_erasure(const v1::AuditEntry& entry) { return entry.what() == "erase_subject" && entry.result() == "ok"; }

/// Returns true if the trail shows an erasure between the last list with the session and the first without it.
bool is_explained(const v1::GetAuditResponse& trail, const MissingSession& session) {
  if (!trail.problem().empty() || trail.entries().empty() || trail.entries(0).utc_ns() > session.listed_utc_ns) return false;
  return std::ranges::any_of(trail.entries(), [&session](const v1::AuditEntry& entry) {
    return is_erasure(entry) && entry.utc_ns() > session.listed_utc_ns - kLongestErasureNs && entry.utc_ns() <= session.missed_utc_ns;
  });
}

}  // namespace

core::Status Outbox::put_changed(const v1::ListSessionsResponse& list, std::int64_t utc_ns, const std::stop_token& stop) {
  for (const v1::SessionRecord& listed : list.sessions()) {
    if (stop.stop_requested()) return core::fail(core::ErrorCode::Failed, "stopped");
    DTS_TRY_ASSIGN(const bool is_changed, store_.is_changed(listed));
    if (!is_changed) continue;
    const auto shown = clinic_.show(listed.session_id());
    if (!shown && shown.error().code == core::ErrorCode::NotFound) continue;  // erased since it was listed
    if (!shown) return tl::make_unexpected(shown.error());
    DTS_TRY(store_.put_session(listed, *shown, rules_, utc_ns));
  }
  return {};
}

core::Status Outbox::look(std::int64_t utc_ns, const std::stop_token& stop) {
  DTS_TRY_ASSIGN(const auto newest, clinic_.list(kNewest, false));
  return put_changed(newest, utc_ns, stop);
}

core::Status Outbox::look_at_all(std::int64_t utc_ns, const std::stop_token& stop) {
  std::vector<std::string> ids;
  bool is_complete = true;
  for (const bool deleted : {false, true}) {
    DTS_TRY_ASSIGN(const auto list, clinic_.list(kMostListed, deleted));
    DTS_TRY(put_changed(list, utc_ns, stop));
    for (const v1::SessionRecord& session : list.sessions()) ids.push_back(session.session_id());
    is_complete = is_complete && static_cast<std::uint32_t>(list.sessions_size()) < kMostListed;
  }
  if (!is_complete) {
    if (utc_ns < completed_utc_ns_ + kAskAgainNs) return {};
    completed_utc_ns_ = utc_ns;
    DTS_TRY(add_unlisted(ids, utc_ns, stop));
  }
  DTS_TRY_ASSIGN(const auto missing, store_.note_list(ids, utc_ns));
  return look_for_erasures(missing, utc_ns);
}

/// A list of dtsd ends after 10,000 sessions. Adds those that it has besides: asks for each that the store knows. Their facts are stored
/// again: the store keeps none that the centre has, and they may have to be sent again.
core::Status Outbox::add_unlisted(std::vector<std::string>& ids, std::int64_t utc_ns, const std::stop_token& stop) {
  DTS_TRY_ASSIGN(const auto known, store_.sessions());
  const std::set<std::string> listed(ids.begin(), ids.end());
  for (const std::string& session : known) {
    if (listed.contains(session)) continue;
    if (stop.stop_requested()) return core::fail(core::ErrorCode::Failed, "stopped");
    const auto shown = clinic_.show(session);
    if (!shown && shown.error().code == core::ErrorCode::NotFound) continue;
    if (!shown) return tl::make_unexpected(shown.error());
    DTS_TRY(store_.put_session(*shown, *shown, rules_, utc_ns));
    ids.push_back(session);
  }
  return {};
}

/// Asks for the audit trail only if another session is missing, or once an hour: dtsd makes an entry in it for each question. An erasure is
/// entered when it has ended, which may be after its sessions are gone.
core::Status Outbox::look_for_erasures(const std::vector<MissingSession>& missing, std::int64_t utc_ns) {
  std::map<std::string, std::int64_t> now;
  for (const MissingSession& session : missing) now.emplace(session.id, session.listed_utc_ns);
  if (now.empty() || (now == unexplained_ && utc_ns < asked_utc_ns_ + kAskAgainNs)) return {};
  asked_utc_ns_ = utc_ns;
  DTS_TRY_ASSIGN(const auto trail, clinic_.audit());
  for (const MissingSession& one : missing) {
    const std::string& session = one.id;
    const auto shown = clinic_.show(session);
    if (shown) {  // restored, or beyond what was listed
      now.erase(session);
      continue;
    }
    if (shown.error().code != core::ErrorCode::NotFound) return tl::make_unexpected(shown.error());
    if (is_explained(trail, one)) {
      DTS_TRY(store_.set_erased(session));
      log_.info("session " + session + " was erased here: the centre is asked to erase it, too");
      now.erase(session);
    } else if (!unexplained_.contains(session)) {
      log_.warning("dtsd does not have session " + session + " any more, but its audit trail has no erasure of it: the centre keeps it");
    }
  }
  unexplained_ = std::move(now);
  return {};
}

}  // namespace dts::fleet::forward
