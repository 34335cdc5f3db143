// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/outbox.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "core/clock.h"

namespace dts::fleet::forward {
namespace {

constexpr std::uint32_t kNewest = 100;
/// The audit trail has the time at which an erasure began. dtsd may have listed its sessions a little longer.
constexpr std::int64_t kLongestErasureNs = 60 * core::kNanosecondsPerSecond;

constexpr std::int64_t kAskAgainNs = 3600 * core::kNanosecondsPerSecond;

bool is_erasure(const v1::AuditEntry& entry) { return entry.what() == "erase_subject" && entry.result() == "ok"; }

/// Returns how many sessions an erasure removed. Its entry has "1 session" or "N sessions".
std::size_t erased_sessions(const v1::AuditEntry& entry) {
  std::size_t count = 0;
  std::from_chars(entry.target().data(), entry.target().data() + entry.target().size(), count);
  return count;
}

/// Returns how many sessions were erased between the last list with this session and the first without it; 0 if the trail does not reach
/// back so far.
std::size_t erased_meanwhile(const v1::GetAuditResponse& trail, const MissingSession& session) {
  if (trail.entries().empty() || trail.entries(0).utc_ns() > session.listed_utc_ns) return 0;
  std::size_t count = 0;
  for (const v1::AuditEntry& entry : trail.entries()) {
    const bool is_meanwhile = entry.utc_ns() > session.listed_utc_ns - kLongestErasureNs && entry.utc_ns() <= session.missed_utc_ns;
    if (is_meanwhile && is_erasure(entry)) count += erased_sessions(entry);
  }
  return count;
}

/// The hash covers the entry and all before it.
std::string text_of(const v1::AuditEntry& entry) { return std::to_string(entry.number()) + " " + entry.hash(); }

/// Returns true if the trail lacks an entry that it had: it is that of another catalogue, for example of one from a backup. An entry that
/// is older than all that dtsd sends proves nothing.
bool is_another_trail(const v1::GetAuditResponse& trail, const std::string& known) {
  std::uint64_t number = 0;
  std::from_chars(known.data(), known.data() + known.size(), number);
  if (known.empty() || (!trail.entries().empty() && trail.entries(0).number() > number)) return false;
  return std::ranges::none_of(trail.entries(), [&known](const v1::AuditEntry& entry) { return text_of(entry) == known; });
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

/// While no session is missing, notes the newest entry, so that a trail from a backup lacks it. Asks for the trail only if another session
/// is missing, or once an hour: dtsd verifies all of it for each question. An erasure is entered when it has ended, which may be after its
/// sessions are gone.
core::Status Outbox::look_for_erasures(const std::vector<MissingSession>& missing, std::int64_t utc_ns) {
  const bool was_asked = utc_ns >= asked_utc_ns_ && utc_ns < asked_utc_ns_ + kAskAgainNs;
  if (missing.empty()) {
    if (was_asked) return {};
    asked_utc_ns_ = utc_ns;
    DTS_TRY_ASSIGN(const auto newest, clinic_.audit(1));
    return note_newest_audit(newest);
  }
  std::map<std::string, std::int64_t> now;
  for (const MissingSession& session : missing) now.emplace(session.id, session.listed_utc_ns);
  if (now == unexplained_ && was_asked) return {};
  asked_utc_ns_ = utc_ns;
  DTS_TRY_ASSIGN(const auto trail, clinic_.audit(kMostListed));
  DTS_TRY_ASSIGN(const auto noted, store_.newest_audit());
  if (trail.problem().empty() && is_another_trail(trail, noted)) {
    for (const MissingSession& session : missing) {
      log_.warning("dtsd does not have session " + session.id +
                   " any more, and its audit trail is another one than before: the centre keeps it");
    }
    DTS_TRY(store_.keep_missing());
  } else {
    DTS_TRY(explain(missing, trail));
  }
  return note_newest_audit(trail);
}

/// Sets those sessions to erased of which the trail proves it.
core::Status Outbox::explain(const std::vector<MissingSession>& missing, const v1::GetAuditResponse& trail) {
  std::vector<MissingSession> gone;
  std::map<std::int64_t, std::size_t> counts;  // missing sessions by the time of the first list without them
  for (const MissingSession& session : missing) {
    const auto shown = clinic_.show(session.id);
    if (shown) continue;  // restored, or beyond what was listed
    if (shown.error().code != core::ErrorCode::NotFound) return tl::make_unexpected(shown.error());
    gone.push_back(session);
    ++counts[session.missed_utc_ns];
  }
  std::map<std::string, std::int64_t> unexplained;
  for (const MissingSession& session : gone) {
    if (trail.problem().empty() && counts[session.missed_utc_ns] <= erased_meanwhile(trail, session)) {
      DTS_TRY(store_.set_erased(session.id));
      log_.info("session " + session.id + " was erased here: the centre is asked to erase it, too");
      continue;
    }
    if (!unexplained_.contains(session.id)) {
      log_.warning("dtsd does not have session " + session.id +
                   " any more, but its audit trail does not show that it was erased: the centre keeps it");
    }
    unexplained.emplace(session.id, session.listed_utc_ns);
  }
  unexplained_ = std::move(unexplained);
  return {};
}

core::Status Outbox::note_newest_audit(const v1::GetAuditResponse& trail) {
  if (!trail.problem().empty() || trail.entries().empty()) return {};
  return store_.set_newest_audit(text_of(*trail.entries().rbegin()));
}

}  // namespace dts::fleet::forward
