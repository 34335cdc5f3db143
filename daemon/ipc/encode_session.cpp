// SPDX-License-Identifier: Apache-2.0
#include "ipc/encode_session.h"

#include <algorithm>
#include <set>

#include "record/old_event.h"
#include "record/recording.h"
#include "record/utf8_text.h"

namespace dts::ipc {

using record::clean_text;
using record::PartState;
using session::SessionState;
using session::TrialPhase;

// The daemon's enumerations have the same numbers as the protobuf ones.
static_assert(static_cast<int>(TrialPhase::Waiting) == dts::v1::TRIAL_PHASE_WAITING);
static_assert(static_cast<int>(TrialPhase::Finished) == dts::v1::TRIAL_PHASE_FINISHED);
static_assert(static_cast<int>(PartState::Recording) == dts::v1::PART_STATE_RECORDING);
static_assert(static_cast<int>(PartState::Missing) == dts::v1::PART_STATE_MISSING);
static_assert(static_cast<int>(session::DiskState::Unusable) == dts::v1::DISK_STATE_UNUSABLE);

// Texts from files, or shortened ones, pass through clean_text: one byte that is not UTF-8 would make the whole answer unreadable.

dts::v1::SessionState session_state(SessionState state) { return static_cast<dts::v1::SessionState>(state); }

dts::v1::SessionInfo session_info(const std::string& rig, const session::SessionView& view) {
  dts::v1::SessionInfo out;
  out.set_session_id(view.id);
  out.set_rig(rig);
  out.set_state(session_state(view.state));
  out.set_protocol(view.id.empty() ? "" : view.request.protocol);
  out.set_subject(view.request.subject);
  out.set_label(view.request.label);
  if (!view.id.empty()) {
    if (view.request.duration_s > 0.0) out.set_duration_s(view.request.duration_s);
    out.set_settle_s(view.request.settle_s);
    out.set_elapsed_s(view.elapsed_s);
  }
  out.set_message(clean_text(view.message));
  for (const auto& [name, value] : view.request.fields) (*out.mutable_fields())[clean_text(name)] = clean_text(value);
  for (const std::string& one : view.rigs) out.add_rigs(one);
  return out;
}

dts::v1::RecordingStatus recording_status(const session::RecordingView& view, std::uint32_t part) {
  dts::v1::RecordingStatus out;
  out.set_is_recording(view.is_recording);
  out.set_part(part);
  out.set_file(clean_text(view.file));
  out.set_bytes(view.bytes);
  out.set_lost_scans_total(view.lost_scans);
  out.set_problem(clean_text(view.problem));
  return out;
}

static dts::v1::TrialOutcome trial_outcome(session::TrialEventKind ended) {
  using enum session::TrialEventKind;
  switch (ended) {
    case Done: return dts::v1::TRIAL_OUTCOME_DONE;
    case Redone: return dts::v1::TRIAL_OUTCOME_REDONE;
    case Rejected: return dts::v1::TRIAL_OUTCOME_REJECTED;
    case Aborted: return dts::v1::TRIAL_OUTCOME_ABORTED;
    default: return dts::v1::TRIAL_OUTCOME_UNSPECIFIED;
  }
}

dts::v1::TrialStatus trial_status(const session::TrialView& view) {
  dts::v1::TrialStatus out;
  out.set_phase(static_cast<dts::v1::TrialPhase>(view.phase));
  out.set_trial(view.trial);
  out.set_attempt(view.attempt);
  out.set_block(view.block);
  out.set_of(view.of);
  out.set_condition(view.condition);
  out.set_next_trial(view.next_trial);
  out.set_next_condition(view.next_condition);
  if (view.next_target_cm) out.set_next_target_cm(*view.next_target_cm);
  if (view.next_target_percent) out.set_next_target_percent(*view.next_target_percent);
  if (view.remaining_s > 0.0) out.set_remaining_s(view.remaining_s);
  out.set_settle_s(view.settle_s);
  if (view.duration_s > 0.0) out.set_duration_s(view.duration_s);
  if (view.target_cm) out.set_target_cm(*view.target_cm);
  if (view.target_percent) out.set_target_percent(*view.target_percent);
  if (view.last_ended) {
    out.set_last_outcome(trial_outcome(view.last_ended->outcome));
    out.set_last_trial(view.last_ended->trial);
    out.set_last_attempt(view.last_ended->attempt);
    out.set_last_fault(view.last_ended->fault);
  }
  if (view.undo_s > 0.0) out.set_undo_s(view.undo_s);
  out.set_is_next_wanted(view.is_next_wanted);
  out.set_has_feedback(view.has_feedback);
  return out;
}

void add_losses(const core::Losses& losses, google::protobuf::RepeatedPtrField<dts::v1::LossCount>& out) {
  for (std::size_t reason = 0; reason < core::kGapReasons; ++reason) {
    const core::LossCount& count = losses.of(static_cast<core::GapReason>(reason));
    if (count == core::LossCount{}) continue;
    auto& loss = *out.Add();
    loss.set_reason(static_cast<dts::v1::GapReason>(reason));
    loss.set_gaps_total(count.gaps);
    loss.set_lost_scans_total(count.scans);
  }
}

static void add_translations(const std::vector<session::Translation>& all, google::protobuf::RepeatedPtrField<dts::v1::Translation>& out) {
  for (const session::Translation& one : all) {
    auto& translation = *out.Add();
    translation.set_language(one.language);
    translation.set_title(one.title);
    translation.set_sentence(one.sentence);
    translation.set_label(one.label);
    translation.set_unit(one.unit);
    translation.set_help(one.help);
    for (const std::string& choice : one.choices) translation.add_choices(choice);
  }
}

static void add_plan(const session::TrialPlan& plan, dts::v1::ProtocolInfo& out) {
  out.set_trials(session::planned_trials(plan));
  out.set_starts_by_itself(plan.starts_by_itself);
  if (const auto length_s = session::length_s(plan)) out.set_length_s(*length_s);
  for (const session::Condition& condition : plan.conditions) {
    auto& described = *out.add_conditions();
    described.set_name(condition.name);
    described.set_title(condition.title);
    described.set_settle_s(plan.settle_s);
    if (plan.duration_s > 0.0) described.set_duration_s(plan.duration_s);
    if (condition.target_percent) described.set_target_percent(*condition.target_percent);
    described.set_is_maximum_reach(condition.is_maximum_reach);
    add_translations(condition.translations, *described.mutable_translations());
    described.set_has_feedback(session::has_feedback(condition));
  }
}

dts::v1::ProtocolInfo protocol_info(const session::Protocol& protocol) {
  dts::v1::ProtocolInfo out;
  out.set_name(protocol.name);
  out.set_title(protocol.title);
  out.set_sentence(protocol.sentence);
  add_translations(protocol.translations, *out.mutable_translations());
  out.set_rig_kind(protocol.rig_kind);
  out.set_settle_s(protocol.settle_s);
  if (protocol.duration_s > 0.0) out.set_duration_s(protocol.duration_s);
  if (protocol.trials) {
    add_plan(*protocol.trials, out);
  } else if (protocol.duration_s > 0.0) {
    out.set_length_s(protocol.settle_s + protocol.duration_s);
  }
  for (const session::ProtocolField& field : protocol.fields) {
    auto& described = *out.add_fields();
    described.set_name(field.name);
    described.set_label(field.label);
    described.set_unit(field.unit);
    described.set_help(field.help);
    described.set_is_required(field.is_required);
    if (field.choices.empty()) {
      described.set_minimum(field.minimum);
      described.set_maximum(field.maximum);
    }
    for (const std::string& choice : field.choices) described.add_choices(choice);
    add_translations(field.translations, *described.mutable_translations());
  }
  return out;
}

namespace {

void fill(dts::v1::SessionPart& out, const record::PartRow& part) {
  out.set_part(part.part);
  out.set_state(static_cast<dts::v1::PartState>(part.state));
  out.set_file(clean_text(part.file));
  out.set_sha256(part.sha256);
  out.set_bytes(part.bytes);
  out.set_scans(part.scans);
  out.set_duration_s(part.duration_s);
  out.set_lost_s_at_most(part.lost_s_at_most);
  out.set_reason(clean_text(part.reason));
  if (part.losses) add_losses(*part.losses, *out.mutable_losses());
  out.set_is_loss_unknown(!part.losses && part.state != record::PartState::Recording);
  out.set_valid_trials(part.valid_trials);
  out.set_rig(clean_text(part.rig));
  if (!part.leads()) out.set_leading_part(part.leading_part);
}

void fill(dts::v1::TrialRecord& out, const record::TrialRow& trial) {
  out.set_part(trial.part);
  out.set_trial(trial.trial);
  out.set_attempt(trial.attempt);
  out.set_block(trial.block);
  out.set_condition(clean_text(trial.condition));
  out.set_outcome(clean_text(trial.outcome));
  out.set_segment(trial.segment);
  out.set_first_scan(trial.first_scan);
  out.set_last_scan(trial.last_scan);
  out.set_last_segment(trial.last_segment);
  out.set_recorded_outcome(clean_text(trial.recorded_outcome));
  if (trial.result.empty()) return;
  auto event = record::event_of_text(trial.result);
  if (event && trial.outcome == "done") out.set_fault(record::fault_of(*event));
  if (event && event->has_trial_result()) {
    *out.mutable_result() = std::move(*event->mutable_trial_result());
    out.mutable_result()->set_session_id(trial.session_id);  // dtsd 0.1 did not store it
  }
  if (event && event->has_sway()) {
    *out.mutable_sway() = std::move(*event->mutable_sway());
    out.mutable_sway()->set_session_id(trial.session_id);
  }
}

void fill(dts::v1::Correction& out, const record::Correction& correction) {
  out.set_number(correction.number);
  out.set_utc_ns(correction.utc_ns);
  out.set_who(clean_text(correction.who));
  out.set_field(std::string(record::name(correction.field)));
  out.set_part(correction.part);
  out.set_trial(correction.trial);
  out.set_attempt(correction.attempt);
  out.set_marker(correction.marker);
  out.set_old_value(clean_text(correction.old_value));
  out.set_new_value(clean_text(correction.new_value));
  out.set_reason(clean_text(correction.reason));
}

bool has_valid_trial(const record::SessionRow& row) {
  return std::ranges::any_of(row.parts, [](const record::PartRow& part) { return part.valid_trials > 0; });
}

}  // namespace

dts::v1::SessionRecord session_record(const record::SessionRow& row, std::uint32_t planned_trials) {
  dts::v1::SessionRecord out;
  out.set_session_id(row.id);
  out.set_rig(clean_text(row.rig));
  out.set_protocol(clean_text(row.protocol));
  out.set_subject(clean_text(row.subject));
  out.set_label(clean_text(row.label));
  out.set_state(record::state_of(row));
  out.set_planned_trials(planned_trials);
  out.set_message(clean_text(row.message));
  out.set_started_utc_ns(row.started_utc_ns);
  if (row.ended_utc_ns != 0) out.set_ended_utc_ns(row.ended_utc_ns);
  for (const record::PartRow& part : row.parts) fill(*out.add_parts(), part);
  for (const record::TrialRow& trial : row.trials) fill(*out.add_trials(), trial);
  for (const record::Correction& correction : row.corrections) fill(*out.add_corrections(), correction);
  for (const record::MarkerRow& marker : row.markers) {
    auto& described = *out.add_markers();
    described.set_number(static_cast<std::uint32_t>(out.markers_size()));
    described.set_part(marker.part);
    described.set_number_in_part(marker.number);
    described.set_segment(marker.segment);
    described.set_scan(marker.scan);
    described.set_text(clean_text(marker.text));
    described.set_recorded_text(clean_text(marker.recorded_text));
  }
  out.set_notes(clean_text(row.notes));
  out.set_is_deleted(row.is_deleted);
  return out;
}

void add_fields(const record::SessionRow& row, dts::v1::SessionRecord& out) {
  for (const record::PartRow& part : row.parts) {
    const auto facts = record::read_session_facts(part.file);
    if (!facts) continue;
    for (const auto& [name, value] : facts->fields) (*out.mutable_fields())[record::clean_text(name)] = record::clean_text(value);
    return;
  }
}

dts::v1::SessionRecord listed_session(const record::SessionRow& row, std::uint32_t planned_trials) {
  constexpr int kListed = 5;
  dts::v1::SessionRecord out = session_record(row, planned_trials);
  out.clear_notes();
  auto& corrections = *out.mutable_corrections();
  if (corrections.size() > kListed) corrections.DeleteSubrange(0, corrections.size() - kListed);
  for (dts::v1::Correction& correction : corrections) {
    for (std::string* text :
         {correction.mutable_who(), correction.mutable_old_value(), correction.mutable_new_value(), correction.mutable_reason()})
      text->clear();
  }
  return out;
}

dts::v1::SubjectInfo subject_info(const record::SubjectRow& row) {
  dts::v1::SubjectInfo out;
  out.set_subject(clean_text(row.subject));
  out.set_sessions(row.sessions);
  out.set_deleted_sessions(row.deleted_sessions);
  out.set_first_utc_ns(row.first_utc_ns);
  out.set_last_utc_ns(row.last_utc_ns);
  out.set_bytes(row.bytes);
  for (const std::string& rig : row.rigs) out.add_rigs(clean_text(rig));
  return out;
}

void add_notes(const record::SubjectNotes& notes, const std::vector<record::SessionRow>& sessions,
               const std::function<std::uint32_t(const record::SessionRow&)>& planned_trials, dts::v1::SubjectRecord& out) {
  for (const record::SubjectNote& note : notes.notes) {
    auto& added = *out.add_notes();
    added.set_number(note.number);
    added.set_utc_ns(note.utc_ns);
    added.set_who(clean_text(note.who));
    added.set_text(clean_text(note.text));
  }
  std::set<std::string> taken;
  for (const record::PlannedSession& planned : notes.plan) {
    auto& added = *out.add_plan();
    added.set_number(planned.number);
    added.set_protocol(clean_text(planned.protocol));
    added.set_due_date(clean_text(planned.due_date));
    added.set_planned_utc_ns(planned.utc_ns);
    added.set_who(clean_text(planned.who));
    const record::SessionRow* done = nullptr;
    for (const record::SessionRow& session : sessions) {
      const std::string state = record::state_of(session);
      const bool fits = session.protocol == planned.protocol && session.started_utc_ns >= planned.utc_ns && !session.is_deleted &&
                        (state == "complete" || state == "recovered") && !taken.contains(session.id) &&
                        (has_valid_trial(session) || planned_trials(session) == 0);
      if (fits && (done == nullptr || session.started_utc_ns < done->started_utc_ns)) done = &session;
    }
    if (done == nullptr) continue;
    taken.insert(done->id);
    added.set_session_id(done->id);
  }
}

dts::v1::SessionResult session_result(const record::ResultRow& row) {
  dts::v1::SessionResult out;
  out.set_name(clean_text(row.name));
  out.set_value(row.value);
  out.set_unit(clean_text(row.unit));
  out.set_details(clean_text(row.details));
  return out;
}

dts::v1::AuditEntry audit_entry(const record::AuditEntry& entry) {
  dts::v1::AuditEntry out;
  out.set_number(entry.number);
  out.set_utc_ns(entry.utc_ns);
  out.set_who(clean_text(entry.who));
  out.set_what(clean_text(entry.what));
  out.set_target(clean_text(entry.target));
  out.set_result(clean_text(entry.result));
  out.set_hash(entry.hash);
  return out;
}

dts::v1::DiskStatus disk_status(const session::DiskView& view) {
  dts::v1::DiskStatus out;
  out.set_state(static_cast<dts::v1::DiskState>(view.state));
  out.set_free_bytes(view.free_bytes);
  out.set_recordable_s(view.recordable_s);
  out.set_directory(clean_text(view.directory));
  out.set_problem(clean_text(view.problem));
  return out;
}

}  // namespace dts::ipc
