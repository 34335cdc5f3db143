// SPDX-License-Identifier: Apache-2.0
#pragma once

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
  core::Result<v1::GetAuditResponse> audit() override {
    if (is_silent) return core::fail(core::ErrorCode::Unreachable, "no answer");
    ++audits;
    return trail;
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
  void add_entry(std::int64_t utc_ns, const std::string& what, const std::string& result = "ok") {
    auto& entry = *trail.add_entries();
    entry.set_utc_ns(utc_ns);
    entry.set_what(what);
    entry.set_result(result);
  }

  std::vector<v1::SessionRecord> sessions;
  v1::GetAuditResponse trail;
  std::vector<std::string> shown;
  int audits = 0;
  bool is_silent = false;
};

}  // namespace dts::fleet::forward
