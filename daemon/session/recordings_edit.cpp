// SPDX-License-Identifier: Apache-2.0
// Corrections of closed sessions.
#include <algorithm>
#include <utility>

#include "session/corrected_results.h"
#include "session/recordings.h"

namespace dts::session {
namespace {

bool has_outcome(const std::vector<record::Correction>& corrections) {
  return std::ranges::find(corrections, record::CorrectedField::Outcome, &record::Correction::field) != corrections.end();
}

/// Returns whether this hides or restores a session, or removes a text: that must be possible, whatever was corrected before.
bool is_removal(const record::Correction& correction) {
  using enum record::CorrectedField;
  return correction.field == Deleted || (record::is_text(correction.field) && correction.new_value.empty());
}

/// Fails if the file, which is about to be replaced, has something that the catalogue does not have.
core::Status check_file(const std::string& file, const record::SessionRow& session) {
  const auto found = record::read_corrections(file);
  if (!found && found.error().code == core::ErrorCode::NotFound) return {};
  if (!found) return tl::make_unexpected(found.error());
  if (found->session_id == session.id && found->all == session.corrections) return {};
  return core::fail(core::ErrorCode::WrongState, "the corrections in '" + file + "' are not those that dtsd knows",
                    "somebody changed this file: restart dtsd, which reads it");
}

}  // namespace

core::Result<record::SessionRow> Recordings::closed_session(const std::string& id) const {
  DTS_TRY_ASSIGN(auto session, catalogue_->session(id));
  if (corrected(session).state == "running") {
    return core::fail(core::ErrorCode::WrongState, "session " + session.id + " is not closed yet",
                      "stop it first: dtsctl session stop --rig " + session.rig);
  }
  if (!owed_.empty()) {
    if (erasing_thread_.joinable()) return written_again();
    return core::fail(core::ErrorCode::Failed, "the catalogue rejects entries at the moment", "see the log of dtsd, then try again");
  }
  return session;
}

core::Status Recordings::correct(const record::SessionRow& session, std::vector<record::Correction> corrections) {
  record::Corrections all{.session_id = session.id, .all = session.corrections};
  const std::size_t most = std::ranges::all_of(corrections, is_removal) ? record::kMostListed : record::kMostCorrections;
  if (all.all.size() + corrections.size() > most) {
    return core::fail(core::ErrorCode::LimitExceeded,
                      "session " + session.id + " already has " + std::to_string(all.all.size()) + " corrections",
                      "a session has at most " + std::to_string(most));
  }
  if (session.parts.empty()) return core::fail(core::ErrorCode::NotFound, "session " + session.id + " has no recording");
  const std::string file = record::corrections_file(session.parts.front().file, session.id);
  DTS_TRY(check_file(file, session));
  const std::int64_t utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns();  // the same for all: they belong together
  for (record::Correction& correction : corrections) {
    correction.utc_ns = utc_ns;
    all.add(std::move(correction));
  }
  std::optional<std::vector<record::ResultRow>> results;
  if (has_outcome(all.all)) {
    record::SessionRow changed = session;
    for (record::TrialRow& trial : changed.trials) {
      if (const std::string* outcome = all.outcome(trial.part, trial.trial, trial.attempt)) trial.outcome = *outcome;
    }
    DTS_TRY_ASSIGN(auto computed, corrected_results(changed));
    results = std::move(computed);
  }
  DTS_TRY(record::write_corrections(file, all));
  auto set = catalogue_->set_corrections(all, results);
  if (!set) complain(record::write_corrections(file, {.session_id = session.id, .all = session.corrections}));
  return explained(std::move(set));
}

/// Computes the results of a session again if outcomes of its trials were corrected.
core::Status Recordings::sum_up(const std::string& session_id) {
  DTS_TRY_ASSIGN(const auto session, catalogue_->session(session_id));
  if (!has_outcome(session.corrections)) return {};
  DTS_TRY_ASSIGN(auto results, corrected_results(session));
  std::ranges::sort(results, {}, &record::ResultRow::name);
  DTS_TRY_ASSIGN(const auto known, catalogue_->results(session_id));
  return results == known ? core::Status() : catalogue_->set_results(session_id, results);
}

void Recordings::sum_up_corrected() {
  const auto corrected = catalogue_->corrections();
  if (!corrected) return complain(tl::make_unexpected(corrected.error()));
  for (const record::Corrections& one : *corrected) {
    if (has_outcome(one.all)) complain(sum_up(one.session_id));
  }
}

}  // namespace dts::session
