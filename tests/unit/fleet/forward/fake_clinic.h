// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "fleet/forward/clinic.h"

namespace dts::fleet::forward {

/// dtsd's catalogue as a list in memory.
class FakeClinic : public Clinic {
 public:
  core::Result<v1::ListSessionsResponse> list(std::uint32_t limit, bool deleted) override {
    if (is_silent) return core::fail(core::ErrorCode::Unreachable, "no answer");
    v1::ListSessionsResponse answer;
    for (const auto& session : sessions) {
      if (session.is_deleted() != deleted || static_cast<std::uint32_t>(answer.sessions_size()) >= limit) continue;
      *answer.add_sessions() = session;
      answer.mutable_sessions(answer.sessions_size() - 1)->clear_trials();
      answer.mutable_sessions(answer.sessions_size() - 1)->clear_results();
    }
    return answer;
  }
  core::Result<v1::SessionRecord> show(const std::string& id) override {
    if (is_silent) return core::fail(core::ErrorCode::Unreachable, "no answer");
    shown.push_back(id);
    for (const auto& session : sessions)
      if (session.session_id() == id) return session;
    return core::fail(core::ErrorCode::NotFound, "no session " + id);
  }
  core::Result<v1::GetAuditResponse> audit(std::uint32_t limit) override {
    if (is_silent) return core::fail(core::ErrorCode::Unreachable, "no answer");
    if (limit > 1) ++whole_audits;
    v1::GetAuditResponse newest = trail;
    const int left_out = std::max(0, trail.entries_size() - static_cast<int>(limit));
    newest.mutable_entries()->DeleteSubrange(0, left_out);
    return newest;
  }

  v1::SessionRecord& add(const std::string& id, std::int64_t started_utc_ns) {
    auto& session = sessions.emplace_back();
    session.set_session_id(id);
    session.set_rig("floor");
    session.set_protocol("free");
    session.set_subject("P017");
    session.set_state("complete");
    session.set_label("Frau Weber");
    session.set_started_utc_ns(started_utc_ns);
    return session;
  }
  static void add_part(v1::SessionRecord& session, const std::string& file, const std::string& sha256, std::uint64_t bytes,
                       v1::PartState state = v1::PART_STATE_COMPLETE) {
    auto& part = *session.add_parts();
    part.set_part(static_cast<std::uint32_t>(session.parts_size()));
    part.set_state(state);
    part.set_file(file);
    part.set_sha256(sha256);
    part.set_bytes(bytes);
  }
  void add_entry(std::int64_t utc_ns, const std::string& what, const std::string& result = "ok", const std::string& target = "") {
    auto& entry = *trail.add_entries();
    entry.set_number(static_cast<std::uint64_t>(trail.entries_size()));
    entry.set_utc_ns(utc_ns);
    entry.set_what(what);
    entry.set_target(target);
    entry.set_result(result);
    entry.set_hash("hash of " + what + " at " + std::to_string(utc_ns));
  }

  std::vector<v1::SessionRecord> sessions;
  v1::GetAuditResponse trail;
  std::vector<std::string> shown;
  int whole_audits = 0;
  bool is_silent = false;
};

}  // namespace dts::fleet::forward
