// SPDX-License-Identifier: Apache-2.0
#include "session/correction_request.h"

#include <algorithm>

#include "session/corrected_results.h"
#include "session/session.h"

namespace dts::session {
namespace {

using core::ErrorCode;
using record::CorrectedField;
using record::Correction;

constexpr std::size_t kLongestNotes = 1000;

void add_if_changed(std::vector<Correction>& corrections, CorrectedField field, const std::string& before,
                    const std::optional<std::string>& wanted) {
  if (wanted && *wanted != before)
    corrections.push_back({.who = {}, .field = field, .old_value = before, .new_value = *wanted, .reason = {}});
}

/// Fails if several parts have the attempt: sessions of earlier builds counted the attempts of each part from 1.
core::Status check_unique(const record::SessionRow& session, const record::TrialRow& wanted) {
  std::string parts;
  for (const record::TrialRow& trial : session.trials) {
    if (trial.trial != wanted.trial || trial.attempt != wanted.attempt || trial.part == wanted.part) continue;
    parts += (parts.empty() ? "" : ", ") + std::to_string(trial.part);
  }
  if (parts.empty()) return {};
  const std::string which = "--trial " + std::to_string(wanted.trial) + " --attempt " + std::to_string(wanted.attempt);
  return core::fail(ErrorCode::InvalidArgument,
                    "parts " + parts + " and " + std::to_string(wanted.part) + " of session " + session.id + " have attempt " +
                        std::to_string(wanted.attempt) + " of trial " + std::to_string(wanted.trial),
                    "name its part: dtsctl session edit " + session.id + " " + which + " --part " + std::to_string(wanted.part));
}

/// Returns the attempt that the request means.
core::Result<const record::TrialRow*> find_trial(const record::SessionRow& session, const CorrectionRequest& request) {
  const record::TrialRow* found = nullptr;  // the rows are sorted by part, trial and attempt: the last one is the newest
  for (const record::TrialRow& trial : session.trials) {
    const bool is_meant = trial.trial == request.trial && (request.attempt == 0 || trial.attempt == request.attempt) &&
                          (request.part == 0 || trial.part == request.part);
    if (is_meant) found = &trial;
  }
  if (found != nullptr) {
    if (request.attempt > 0 && request.part == 0) DTS_TRY(check_unique(session, *found));
    return found;
  }
  const std::string attempt = request.attempt > 0 ? "attempt " + std::to_string(request.attempt) + " of " : "";
  const std::string part = request.part > 0 ? " in part " + std::to_string(request.part) : "";
  return core::fail(ErrorCode::NotFound, "session " + session.id + " has no " + attempt + "trial " + std::to_string(request.trial) + part,
                    "see its trials: dtsctl session show " + session.id);
}

/// Fails if the attempt cannot be the one whose values are used.
core::Status check_done(const record::SessionRow& session, const record::TrialRow& wanted) {
  const std::string which = "trial " + std::to_string(wanted.trial) + ", attempt " + std::to_string(wanted.attempt) + ",";
  if (wanted.result.empty() && has_trial_results(session)) {
    return core::fail(ErrorCode::WrongState, which + " has no values: it ended before it was measured, so it cannot be done",
                      "repeat the trial in a new session");
  }
  for (const record::TrialRow& trial : session.trials) {
    const bool is_other = &trial != &wanted && trial.trial == wanted.trial;
    if (!is_other || trial.outcome != "done") continue;
    const std::string other =
        "attempt " + std::to_string(trial.attempt) + (trial.part == wanted.part ? "" : " of part " + std::to_string(trial.part));
    return core::fail(ErrorCode::WrongState, which + " cannot be done, because " + other + " is done: a trial is valid once",
                      "first correct " + other + " to redone");
  }
  return {};
}

core::Status add_outcome(const record::SessionRow& session, const CorrectionRequest& request, std::vector<Correction>& corrections) {
  if (request.trial == 0 && request.outcome.empty()) return {};
  if (request.trial == 0 || request.outcome.empty()) {
    return core::fail(ErrorCode::InvalidArgument, "a corrected outcome needs both a trial and an outcome",
                      "dtsctl session edit " + session.id + " --trial 3 --outcome rejected --reason TEXT");
  }
  if (std::ranges::find(record::kTrialOutcomes, request.outcome) == record::kTrialOutcomes.end()) {
    return core::fail(ErrorCode::InvalidArgument, "the outcome is not known", "use done, redone, rejected or aborted");
  }
  DTS_TRY_ASSIGN(const auto trial, find_trial(session, request));
  if (trial->outcome == request.outcome) return {};
  if (request.outcome == "done") DTS_TRY(check_done(session, *trial));
  corrections.push_back({.who = {},
                         .field = CorrectedField::Outcome,
                         .part = trial->part,
                         .trial = trial->trial,
                         .attempt = trial->attempt,
                         .old_value = trial->outcome,
                         .new_value = request.outcome,
                         .reason = {}});
  return {};
}

core::Status add_marker(const record::SessionRow& session, const CorrectionRequest& request, const LabelRule& rule,
                        std::vector<Correction>& corrections) {
  if (request.marker == 0 && !request.marker_text) return {};
  if (request.marker == 0 || !request.marker_text) {
    return core::fail(ErrorCode::InvalidArgument, "a corrected marker needs both its number and its text",
                      "dtsctl session edit " + session.id + " --marker 2 --text TEXT --reason TEXT");
  }
  DTS_TRY(check_label(rule, "marker", *request.marker_text));
  if (request.marker > session.markers.size()) {
    return core::fail(ErrorCode::NotFound, "session " + session.id + " has no marker " + std::to_string(request.marker),
                      "see its markers: dtsctl session show " + session.id);
  }
  const record::MarkerRow& marker = session.markers[request.marker - 1];
  if (marker.text == *request.marker_text) return {};
  corrections.push_back({.who = {},
                         .field = CorrectedField::Marker,
                         .part = marker.part,
                         .marker = marker.number,
                         .old_value = marker.text,
                         .new_value = *request.marker_text,
                         .reason = {}});
  return {};
}

}  // namespace

core::Status check_reason(const std::string& reason, const LabelRule& rule) {
  if (reason.empty()) {
    return core::fail(ErrorCode::InvalidArgument, "the reason is missing", "say why, in a few words and without names: --reason TEXT");
  }
  return check_sentences(rule, "reason", reason);
}

core::Result<std::vector<Correction>> corrections_for(const record::SessionRow& session, const CorrectionRequest& request,
                                                      const LabelRule& rule) {
  DTS_TRY(check_reason(request.reason, rule));
  if (request.subject) DTS_TRY(check({.subject = *request.subject, .label = {}}));
  // An unchanged ID may be older than the rule.
  if (request.subject && *request.subject != session.subject) DTS_TRY(check_subject(rule, *request.subject));
  if (request.label) DTS_TRY(check_label(rule, "label", *request.label));
  if (request.notes) DTS_TRY(check_sentences(rule, "text of the notes", *request.notes, kLongestNotes));
  std::vector<Correction> corrections;
  add_if_changed(corrections, CorrectedField::Subject, session.subject, request.subject);
  add_if_changed(corrections, CorrectedField::Label, session.label, request.label);
  add_if_changed(corrections, CorrectedField::Notes, session.notes, request.notes);
  DTS_TRY(add_outcome(session, request, corrections));
  DTS_TRY(add_marker(session, request, rule, corrections));
  if (corrections.empty()) {
    return core::fail(ErrorCode::InvalidArgument, "nothing to correct: session " + session.id + " already has these values",
                      "see dtsctl session show " + session.id);
  }
  for (Correction& correction : corrections) correction.reason = request.reason;
  return corrections;
}

}  // namespace dts::session
