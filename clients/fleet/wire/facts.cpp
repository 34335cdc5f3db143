// SPDX-License-Identifier: Apache-2.0
#include "fleet/wire/facts.h"

#include <cstdint>

#include "fleet/wire/messages.h"

namespace dts::fleet::wire {
namespace {

void add(const v1::SessionPart& part, v1::FleetPart& out) {
  out.set_part(part.part());
  out.set_state(part.state());
  if (auto recorded = bytes_of_hex(part.sha256())) out.set_recorded_sha256(std::move(*recorded));
  out.set_bytes(part.bytes());
  out.set_scans(part.scans());
  out.set_duration_s(part.duration_s());
  std::uint64_t lost = 0;
  for (const v1::LossCount& loss : part.losses()) lost += loss.lost_scans_total();
  out.set_lost_scans(lost);
  out.set_is_loss_unknown(part.is_loss_unknown());
  out.set_valid_trials(part.valid_trials());
  out.set_rig(part.rig());
  out.set_leading_part(part.leading_part());
}

void add(const v1::TrialRecord& trial, v1::FleetTrial& out) {
  out.set_part(trial.part());
  out.set_trial(trial.trial());
  out.set_attempt(trial.attempt());
  out.set_block(trial.block());
  out.set_condition(trial.condition());
  out.set_outcome(trial.outcome());
  out.set_recorded_outcome(trial.recorded_outcome());
  out.set_fault(trial.fault());
}

}  // namespace

v1::FleetSession facts_of(const v1::SessionRecord& session, const SendRules& rules) {
  v1::FleetSession out;
  out.set_session_id(session.session_id());
  out.set_rig(session.rig());
  out.set_protocol(session.protocol());
  out.set_subject(session.subject());
  out.set_state(session.state());
  out.set_started_utc_ns(session.started_utc_ns());
  if (session.has_ended_utc_ns()) out.set_ended_utc_ns(session.ended_utc_ns());
  out.set_planned_trials(session.planned_trials());
  for (const v1::SessionPart& part : session.parts()) add(part, *out.add_parts());
  for (const v1::TrialRecord& trial : session.trials()) add(trial, *out.add_trials());
  for (const v1::SessionResult& result : session.results()) {
    v1::FleetResult& sent = *out.add_results();
    sent.set_name(result.name());
    sent.set_value(result.value());
    sent.set_unit(result.unit());
  }
  out.set_is_deleted(session.is_deleted());
  if (rules.labels) {
    out.set_label(session.label());
    out.set_notes(session.notes());
  }
  for (const auto& [name, value] : session.fields()) {
    if (rules.fields.contains(name)) (*out.mutable_fields())[name] = value;
  }
  return out;
}

}  // namespace dts::fleet::wire
