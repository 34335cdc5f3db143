// SPDX-License-Identifier: Apache-2.0
// Corrections of closed sessions.
#include <algorithm>
#include <utility>

#include "session/corrected_results.h"
#include "session/recordings.h"

namespace dts::session {

core::Result<record::SessionRow> Recordings::closed_session(const std::string& id) const {
  DTS_TRY_ASSIGN(auto session, catalogue_->session(id));
  if (corrected(session).state == "running") {
    return core::fail(core::ErrorCode::WrongState, "session " + session.id + " is not closed yet",
                      "stop it first: dtsctl session stop --rig " + session.rig);
  }
  if (!owed_.empty()) {
    return core::fail(core::ErrorCode::Failed, "the catalogue rejects entries at the moment", "see the log of dtsd, then try again");
  }
  return session;
}

core::Status Recordings::correct(const record::SessionRow& session, std::vector<record::Correction> corrections) {
  record::Corrections all{.session_id = session.id, .all = session.corrections};
  if (all.all.size() + corrections.size() > record::kMostCorrections) {
    return core::fail(core::ErrorCode::LimitExceeded,
                      "session " + session.id + " already has " + std::to_string(all.all.size()) + " corrections",
                      "a session has at most " + std::to_string(record::kMostCorrections));
  }
  if (session.parts.empty()) return core::fail(core::ErrorCode::NotFound, "session " + session.id + " has no recording");
  const bool has_outcome = std::ranges::find(corrections, record::CorrectedField::Outcome, &record::Correction::field) != corrections.end();
  const std::int64_t utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns();  // the same for all: they belong together
  for (record::Correction& correction : corrections) {
    correction.utc_ns = utc_ns;
    all.add(std::move(correction));
  }
  const std::string file = record::corrections_file(session.parts.front().file, session.id);
  DTS_TRY(record::write_corrections(file, all));
  if (auto set = catalogue_->set_corrections(all); !set) {
    complain(record::write_corrections(file, {.session_id = session.id, .all = session.corrections}));
    return set;
  }
  if (has_outcome) complain(sum_up(session.id));
  return {};
}

/// Computes the results of a session again if outcomes of its trials were corrected.
core::Status Recordings::sum_up(const std::string& session_id) {
  DTS_TRY_ASSIGN(const auto session, catalogue_->session(session_id));
  const auto& corrections = session.corrections;
  if (std::ranges::find(corrections, record::CorrectedField::Outcome, &record::Correction::field) == corrections.end()) return {};
  DTS_TRY_ASSIGN(const auto results, corrected_results(session));
  return catalogue_->set_results(session_id, results);
}

}  // namespace dts::session
