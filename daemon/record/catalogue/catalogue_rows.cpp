// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/catalogue_rows.h"

#include <algorithm>
#include <sstream>
#include <string_view>

#include "record/losses.h"
#include "record/old_event.h"

namespace dts::record {

namespace {

v1::TrialFault reach_fault(const v1::TrialResult& result) {
  if (result.has_reach()) return v1::TRIAL_FAULT_UNSPECIFIED;
  if (result.has_gap()) return v1::TRIAL_FAULT_NO_VALUES;
  // A reach within arm's length hardly moves the seat: then "no reach" is the expected result.
  const bool is_expected = result.has_expected_class() && result.expected_class() == 0;
  return is_expected ? v1::TRIAL_FAULT_UNSPECIFIED : v1::TRIAL_FAULT_NO_REACH;
}

}  // namespace

v1::TrialFault fault_of(const v1::Event& result) {
  if (result.has_trial_result()) return reach_fault(result.trial_result());
  if (!result.has_sway() || result.sway().is_preliminary()) return v1::TRIAL_FAULT_UNSPECIFIED;
  const v1::Sway& sway = result.sway();
  if ((sway.flags() & v1::SWAY_FLAG_STEPPED_OFF) != 0) return v1::TRIAL_FAULT_STEPPED_OFF;
  if ((sway.flags() & v1::SWAY_FLAG_MOVED) != 0) return v1::TRIAL_FAULT_FEET_MOVED;
  return sway.is_valid() ? v1::TRIAL_FAULT_UNSPECIFIED : v1::TRIAL_FAULT_NO_VALUES;
}

bool is_valid(const TrialRow& trial) {
  if (trial.outcome != "done") return false;
  const auto result = event_of_text(trial.result);
  if (!result) return trial.result.empty();  // a result that cannot be read proves nothing
  return fault_of(*result) == v1::TRIAL_FAULT_UNSPECIFIED;
}

std::string state_of(const SessionRow& session) {
  if (session.state != "complete") return session.state;
  const auto has = [&session](PartState state) { return std::ranges::count(session.parts, state, &PartRow::state); };
  const auto others = std::ssize(session.parts) - has(PartState::Complete);
  if (others == 0) return session.state;
  return others == has(PartState::Recovered) ? "recovered" : "incomplete";
}

std::vector<std::string> rigs_of(const SessionRow& session) {
  std::vector<std::string> rigs{session.rig};
  for (const PartRow& part : session.parts) {
    if (std::ranges::find(rigs, part.rig) == rigs.end()) rigs.push_back(part.rig);
  }
  return rigs;
}

std::vector<PartRow> newest_parts(const SessionRow& session) {
  std::vector<PartRow> newest;
  for (const PartRow& part : session.parts) {
    if (!newest.empty() && part.leading_part > newest.front().leading_part) newest.clear();
    if (newest.empty() || part.leading_part == newest.front().leading_part) newest.push_back(part);
  }
  return newest;
}

std::string worse_state(const std::string& a, const std::string& b) {
  for (const std::string_view state : {"aborted", "interrupted", "incomplete"}) {
    if (a == state || b == state) return std::string(state);
  }
  return "complete";
}

SessionRow read_session(Statement& row) {
  SessionRow session;
  session.id = row.text(0);
  session.rig = row.text(1);
  session.protocol = row.text(2);
  session.subject = row.text(3);
  session.label = row.text(4);
  session.state = row.text(5);
  session.message = row.text(6);
  session.started_utc_ns = row.integer(7);
  session.ended_utc_ns = row.integer(8);
  session.protocol_definition = row.text(9);
  session.recorded_subject = row.text(10);
  session.recorded_label = row.text(11);
  session.notes = row.text(12);
  session.is_deleted = row.integer_in(13, 0, 1) == 1;
  return session;
}

PartRow read_part(Statement& row) {
  PartRow part;
  part.session_id = row.text(0);
  part.part = row.count32(1);
  part.file = row.text(2);
  part.state = static_cast<PartState>(row.integer_in(3, static_cast<int>(PartState::Recording), static_cast<int>(PartState::Missing)));
  part.sha256 = row.text(4);
  part.bytes = row.count(5);
  part.scans = row.count(6);
  part.duration_s = row.number(7);
  part.lost_s_at_most = row.number(8);
  part.reason = row.text(9);
  part.started_utc_ns = row.integer(10);
  part.losses = losses_of_json(row.text(11));
  part.valid_trials = row.count32(12);
  part.rig = row.text(13);
  part.leading_part = row.count32(14);
  return part;
}

TrialRow read_trial(Statement& row) {
  TrialRow trial;
  trial.session_id = row.text(0);
  trial.part = row.count32(1);
  trial.trial = row.count32(2);
  trial.attempt = row.count32(3);
  trial.block = row.count32(4);
  trial.condition = row.text(5);
  trial.outcome = row.text(6);
  trial.segment = row.count32(7);
  trial.first_scan = row.count(8);
  trial.last_scan = row.count(9);
  trial.last_segment = row.count32(10);
  trial.result = row.text(11);
  trial.recorded_outcome = row.text(12);
  return trial;
}

Correction read_correction(Statement& row) {
  Correction correction;
  correction.number = row.count32(0);
  correction.utc_ns = row.integer(1);
  correction.who = row.text(2);
  correction.field =
      static_cast<CorrectedField>(row.integer_in(3, static_cast<int>(CorrectedField::Subject), static_cast<int>(CorrectedField::Marker)));
  correction.part = row.count32(4);
  correction.trial = row.count32(5);
  correction.attempt = row.count32(6);
  correction.marker = row.count32(7);
  correction.old_value = row.text(8);
  correction.new_value = row.text(9);
  correction.reason = row.text(10);
  return correction;
}

MarkerRow read_marker(Statement& row) {
  MarkerRow marker;
  marker.session_id = row.text(0);
  marker.part = row.count32(1);
  marker.number = row.count32(2);
  marker.segment = row.count32(3);
  marker.scan = row.count(4);
  marker.text = row.text(5);
  return marker;
}

SubjectRow read_subject(Statement& row) {
  SubjectRow subject;
  subject.subject = row.text(0);
  subject.sessions = row.count32(1);
  subject.deleted_sessions = row.count32(2);
  subject.first_utc_ns = row.integer(3);
  subject.last_utc_ns = row.integer(4);
  subject.bytes = row.count(5);
  std::istringstream rigs(row.text(6));  // names of rigs have no comma
  for (std::string rig; std::getline(rigs, rig, ',');) subject.rigs.push_back(rig);
  std::ranges::sort(subject.rigs);
  return subject;
}

ResultRow read_result(Statement& row) {
  ResultRow result;
  result.session_id = row.text(0);
  result.name = row.text(1);
  result.value = row.number(2);
  result.unit = row.text(3);
  result.details = row.text(4);
  return result;
}

}  // namespace dts::record
