// SPDX-License-Identifier: Apache-2.0
#include "ctl/session_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/table.h"
#include "ctl/json.h"
#include "ctl/reach_reading.h"
#include "ctl/recording_view.h"
#include "ctl/sway_reading.h"
#include "report/decision_words.h"
#include "report/result_names.h"

namespace dts::ctl {
namespace {

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }

std::string state_word(v1::PartState state) { return enumerator_word(*v1::PartState_descriptor(), state); }

/// Returns the session's state and, in brackets, the losses of its recordings: "complete (10560 scans lost in 1 gap)".
std::string state_text(const v1::SessionRecord& session) {
  const std::string lost = loss_text(sum_of(session));
  std::string text = or_dash(session.state()) + (lost.empty() ? "" : " (" + lost + ")");
  const auto is_value = [](const v1::Correction& correction) { return correction.field() != "deleted"; };
  if (std::ranges::any_of(session.corrections(), is_value)) text += ", corrected";
  return text + (session.is_deleted() ? ", deleted" : "");
}

/// Prints the markers; the number is the one that `session edit --marker` needs.
void print_markers(cli::Console& console, const v1::SessionRecord& session) {
  cli::Table markers({">MARKER", ">PART", ">SEGMENT", ">SCAN", "TEXT"});
  for (const v1::MarkerRecord& marker : session.markers()) {
    const std::string text = marker.text().empty() ? "(removed)" : marker.text();
    markers.add({{std::to_string(marker.number())},
                 {std::to_string(marker.part())},
                 {std::to_string(marker.segment())},
                 {std::to_string(marker.scan())},
                 {marker.recorded_text().empty() ? text : text + " (corrected; recorded: " + marker.recorded_text() + ")"}});
  }
  if (session.markers_size() > 0) console.out << '\n';
  markers.may_drop({"SEGMENT", "PART"});
  markers.print(console);
}

void print_corrections(cli::Console& console, const v1::SessionRecord& session) {
  if (session.corrections_size() > 0) console.out << "\ncorrections (the recording stays as it is):\n";
  for (const v1::Correction& correction : session.corrections()) {
    console.out << "  " << cli::wrapped_at(console, 2, cli::printable(correction_text(correction))) << '\n';
  }
}

/// Returns the time of the leading rig: the others recorded at the same time.
double recorded_s(const v1::SessionRecord& session) {
  double sum_s = 0.0;
  for (const v1::SessionPart& part : session.parts()) {
    if (part.leading_part() == 0) sum_s += part.duration_s();
  }
  return sum_s;
}

/// Returns "floor, plate", the leading rig first.
std::string rigs_text(const v1::SessionRecord& session) {
  std::vector<std::string> rigs{session.rig()};
  for (const v1::SessionPart& part : session.parts()) {
    if (part.leading_part() != 0 && std::ranges::find(rigs, part.rig()) == rigs.end()) rigs.push_back(part.rig());
  }
  return cli::join(rigs, ", ");
}

void print_parts(cli::Console& console, const v1::SessionRecord& session) {
  cli::Table parts({">PART", "RIG", "STATE", ">LENGTH", ">SCANS", ">SIZE", "FILE"});
  for (const v1::SessionPart& part : session.parts()) {
    parts.add({{std::to_string(part.part())},
               {or_dash(part.rig())},
               state_cell(state_word(part.state())),
               {cli::duration(part.duration_s())},
               {std::to_string(part.scans())},
               {bytes_text(part.bytes())},
               {or_dash(part.file())}});
  }
  if (session.parts_size() > 0) console.out << '\n';
  parts.print(console);
  for (const v1::SessionPart& part : session.parts()) {
    if (part.sha256().empty()) continue;
    const std::string sum = "part " + std::to_string(part.part()) + ": SHA-256 " + cli::printable(part.sha256());
    console.out << cli::styled(console, cli::Style::Faint, sum) << '\n';
  }
  for (const v1::SessionPart& part : session.parts()) {
    const std::string lost = losses_text(part);
    if (lost.empty()) continue;
    console.out << cli::styled(console, cli::Style::Warning, "part " + std::to_string(part.part()) + ": " + lost) << '\n';
  }
  for (const v1::SessionPart& part : session.parts()) {
    if (part.reason().empty() && !(part.lost_s_at_most() > 0.0)) continue;
    const std::string lost = part.lost_s_at_most() > 0.0 ? "at most " + cli::decimal(part.lost_s_at_most(), 2) + " s lost" : "";
    const std::string why = part.reason() + (part.reason().empty() || lost.empty() ? "" : "; ") + lost;
    console.out << cli::styled(console, cli::Style::Bad, "part " + std::to_string(part.part()) + ": " + cli::printable(why)) << '\n';
  }
}

/// Returns the class of a trial of the reaching task; highlights a class that is not expected for this target.
cli::Cell trunk_cell(const v1::TrialResult& result) {
  if (!result.has_movement()) return {"-"};
  const int found = result.movement().trunk_class();
  const std::string words = class_words(result.movement(), result.reach().flags());
  if (found < 0) return {words, cli::Style::Faint};
  if (!result.has_expected_class()) return {words};
  const bool is_arm_alone = found == 1 && result.expected_class() == 0 && words != class_word(found);
  if (result.expected_class() < 0 || result.expected_class() == found || is_arm_alone) return {words};
  return {words + " (expected: " + class_word(result.expected_class()) + ")", cli::Style::Warning};
}

void print_results(cli::Console& console, const v1::SessionRecord& session) {
  cli::Table results({"RESULT", ">VALUE", "UNIT"});
  for (const v1::SessionResult& result : session.results()) {
    results.add({{report::result_label(result.name())}, {cli::decimal(result.value(), 3)}, {result.unit() == "1" ? "" : result.unit()}});
  }
  if (session.results_size() > 0) console.out << '\n';
  if (session.results_size() > 0) results.print(console);
  for (const v1::SessionResult& result : session.results()) {
    const cli::Json details = cli::Json::parse(result.details(), nullptr, false);
    if (!details.is_object() || !details.contains("note") || !details.at("note").is_string()) continue;
    console.out << cli::printable(report::result_label(result.name())) << ": " << cli::printable(details.at("note").get<std::string>())
                << '\n';
  }
}

/// Returns "812 .. 2312"; "0:812 .. 1:212" (segment:scan) if the trial has a gap.
std::string place_text(const v1::TrialRecord& trial) {
  if (trial.last_segment() <= trial.segment()) return std::to_string(trial.first_scan()) + " .. " + std::to_string(trial.last_scan());
  return std::to_string(trial.segment()) + ":" + std::to_string(trial.first_scan()) + " .. " + std::to_string(trial.last_segment()) + ":" +
         std::to_string(trial.last_scan());
}

/// Returns the outcome, and for a trial that was done but does not count, why.
cli::Cell recorded_cell(const v1::TrialRecord& trial) {
  if (trial.outcome() != "done") return {trial.outcome(), cli::Style::Warning};
  if (trial.fault() != v1::TRIAL_FAULT_UNSPECIFIED) return {"done, not valid: " + report::fault_words(trial.fault()), cli::Style::Warning};
  const v1::Sway& sway = trial.sway();
  if ((sway.flags() & v1::SWAY_FLAG_CUT_AT_GAP) != 0) return {"done, cut short by a gap", cli::Style::Warning};
  return {"done", cli::Style::Good};
}

/// Returns the outcome; for a corrected one, with the recorded one.
cli::Cell outcome_cell(const v1::TrialRecord& trial) {
  cli::Cell cell = recorded_cell(trial);
  if (!trial.recorded_outcome().empty()) cell.text += " (corrected; recorded: " + trial.recorded_outcome() + ")";
  return cell;
}

cli::Cell decision_cell(const v1::TrialRecord& trial) {
  const v1::SteadinessDecision* decision = report::kept_decision(trial);
  if (decision == nullptr) return {"-"};
  const bool is_decided = decision->outcome() == v1::DECISION_OUTCOME_DECIDED;
  return {report::decision_text(*decision), is_decided ? cli::Style::Plain : cli::Style::Warning};
}

/// Prints what must stand beside the decisions, once for each model.
void print_decision_limits(cli::Console& console, const v1::SessionRecord& session) {
  std::set<std::string> limits;
  for (const v1::TrialRecord& trial : session.trials()) {
    if (const auto* decision = report::kept_decision(trial)) limits.insert(cli::join(report::decision_limits(*decision), " "));
  }
  for (const std::string& text : limits) console.out << cli::printable(text) << '\n';
}

/// Prints trials of quiet standing.
void print_standing(cli::Console& console, const v1::SessionRecord& session) {
  const bool has_decisions = std::ranges::any_of(session.trials(), report::kept_decision);
  std::vector<std::string> headers{">TRIAL",         ">ATTEMPT",     "CONDITION",    "OUTCOME", ">LENGTH",
                                   ">VELOCITY mm/s", ">DISTANCE mm", ">ELLIPSE mm2", "FLAGS"};
  if (has_decisions) headers.emplace_back("DECISION");
  headers.insert(headers.end(), {">PART", ">FROM .. TO SCAN"});
  cli::Table trials(headers);
  const auto value = [](const v1::Sway& sway, const char* symbol, int decimals) {
    return cli::decimal(measure_value(sway, symbol).value_or(std::numeric_limits<double>::quiet_NaN()), decimals);
  };
  for (const v1::TrialRecord& trial : session.trials()) {
    const v1::Sway& sway = trial.sway();
    const bool has_values = trial.has_sway() && sway.problem().empty();
    std::vector<cli::Cell> row{{std::to_string(trial.trial())},
                               {std::to_string(trial.attempt())},
                               {trial.condition()},
                               outcome_cell(trial),
                               {has_values ? cli::duration(sway.duration_s()) : "-"},
                               {value(sway, "MVELO", 2)},
                               {value(sway, "RDIST", 2)},
                               {value(sway, "PEA95_F", 1)},
                               {sway.problem().empty() ? sway_flag_words(sway) : sway.problem(),
                                has_values && sway.is_valid() ? cli::Style::Plain : cli::Style::Warning}};
    if (has_decisions) row.push_back(decision_cell(trial));
    row.insert(row.end(), {{std::to_string(trial.part())}, {place_text(trial)}});
    trials.add(std::move(row));
  }
  console.out << '\n';
  trials.may_drop({"FROM .. TO SCAN", "PART", "ATTEMPT", "LENGTH"});
  trials.print(console);
  print_decision_limits(console, session);
}

/// For a session in which no trial has a result: the columns of no task would help.
void print_without_results(cli::Console& console, const v1::SessionRecord& session) {
  cli::Table trials({">TRIAL", ">ATTEMPT", ">BLOCK", "CONDITION", "OUTCOME", ">PART", ">SEGMENT", ">FROM .. TO SCAN"});
  for (const v1::TrialRecord& trial : session.trials()) {
    trials.add({{std::to_string(trial.trial())},
                {std::to_string(trial.attempt())},
                {std::to_string(trial.block())},
                {trial.condition()},
                outcome_cell(trial),
                {std::to_string(trial.part())},
                {std::to_string(trial.segment())},
                {place_text(trial)}});
  }
  if (session.trials_size() > 0) console.out << '\n';
  trials.may_drop({"FROM .. TO SCAN", "SEGMENT", "PART", "BLOCK"});
  trials.print(console);
}

void print_trials(cli::Console& console, const v1::SessionRecord& session) {
  if (std::ranges::any_of(session.trials(), &v1::TrialRecord::has_sway)) return print_standing(console, session);
  if (std::ranges::none_of(session.trials(), &v1::TrialRecord::has_result)) return print_without_results(console, session);
  cli::Table trials({">TRIAL", ">ATTEMPT", ">BLOCK", "CONDITION", "OUTCOME", ">P1 mm", ">P2 mm", ">P3 mm", "TRUNK", "p 1 2 3",
                     ">DEG (90 %)", ">PART", ">SEGMENT", ">FROM .. TO SCAN"});
  for (const v1::TrialRecord& trial : session.trials()) {
    trials.add({{std::to_string(trial.trial())},
                {std::to_string(trial.attempt())},
                {std::to_string(trial.block())},
                {trial.condition()},
                outcome_cell(trial),
                {point_text(trial.result().reach().has_p1(), trial.result().reach().p1())},
                {point_text(trial.result().reach().has_p2(), trial.result().reach().p2())},
                {point_text(trial.result().reach().has_p3(), trial.result().reach().p3())},
                trunk_cell(trial.result()),
                {probabilities_text(trial.result().movement())},
                {trial.result().has_movement() ? degrees_text(trial.result().movement()) : "-"},
                {std::to_string(trial.part())},
                {std::to_string(trial.segment())},
                {place_text(trial)}});
  }
  if (session.trials_size() > 0) console.out << '\n';
  trials.may_drop({"FROM .. TO SCAN", "SEGMENT", "PART", "p 1 2 3", "BLOCK", "P1 mm", "P2 mm", "P3 mm"});
  trials.print(console);
}

/// Returns "4 x (5 + 30) s, 2 min 20 s, plus the pauses you decide".
std::string length_text(const v1::ProtocolInfo& protocol) {
  if (protocol.conditions_size() == 0) return protocol.duration_s() > 0.0 ? cli::duration(protocol.length_s()) : "until stopped";
  const v1::ProtocolCondition& condition = protocol.conditions(0);
  const std::string pauses = protocol.starts_by_itself() || protocol.trials() == 1 ? "" : ", plus the pauses you decide";
  const std::string settling = condition.settle_s() > 0.0 ? shortest(condition.settle_s()) + " s to settle, then " : "";
  if (!(condition.duration_s() > 0.0)) return counted(protocol.trials(), "trial") + ", each " + settling + "until you end it";
  const std::string trial = settling.empty() ? shortest(condition.duration_s())
                                             : "(" + shortest(condition.settle_s()) + " + " + shortest(condition.duration_s()) + ")";
  const double trials_s = protocol.trials() * (condition.settle_s() + condition.duration_s());
  const bool has_more = protocol.length_s() > trials_s + 0.5;
  return std::to_string(protocol.trials()) + " x " + trial + " s, " + cli::duration(protocol.length_s()) +
         (has_more ? " with cues and rests" : "") + pauses;
}

std::string target_text(const v1::ProtocolCondition& condition) {
  if (condition.is_maximum_reach()) return "maximum reach";
  return condition.target_percent() > 0.0 ? shortest(condition.target_percent()) + " % of arm length" : "-";
}

}  // namespace

void print_sessions(cli::Console& console, const v1::ListSessionsResponse& sessions) {
  cli::Table table({"SESSION", "RIG", "PROTOCOL", "SUBJECT", "STARTED (UTC)", ">LENGTH", "TRIALS", "STATE", "LABEL"});
  for (const v1::SessionRecord& session : sessions.sessions()) {
    const std::string trials = trials_text(valid_trials(session), session.planned_trials());
    const bool is_empty = session.planned_trials() > 0 && valid_trials(session) == 0 && session.state() != "running";
    table.add({{session.session_id(), cli::Style::Bold},
               {rigs_text(session)},
               {or_dash(session.protocol())},
               {or_dash(session.subject())},
               {utc_text(session.started_utc_ns())},
               {session.state() == "running" ? "-" : cli::duration(recorded_s(session))},
               {or_dash(trials.substr(0, trials.rfind(" trials"))), is_empty ? cli::Style::Bad : cli::Style::Plain},
               state_cell(state_text(session)),
               {session.label()}});
  }
  if (sessions.sessions_size() == 0) console.out << "no sessions\n";
  table.may_drop({"STARTED (UTC)", "RIG", "LENGTH", "LABEL"});
  table.print(console);
}

void print_session(cli::Console& console, const v1::SessionRecord& session, std::optional<double> elapsed_s) {
  print_field(console, "session", session.session_id());
  print_field(console, "rig", rigs_text(session));
  print_field(console, "protocol", session.protocol());
  print_field(console, "subject", session.subject());
  for (const auto& [name, value] : std::map<std::string, std::string>(session.fields().begin(), session.fields().end())) {
    print_field(console, name, value);
  }
  print_field(console, "label", session.label());
  print_field(console, "notes", session.notes());
  print_field(console, "started", utc_text(session.started_utc_ns()) + " UTC");
  if (session.ended_utc_ns() != 0) print_field(console, "ended", utc_text(session.ended_utc_ns()) + " UTC");
  if (elapsed_s) {
    print_field(console, "elapsed", cli::duration(*elapsed_s));
  } else {
    print_field(console, "recorded", cli::duration(recorded_s(session)));
  }
  print_field(console, "trials", trials_text(valid_trials(session), session.planned_trials()));
  print_field(console, "state", state_text(session) + (session.message().empty() ? "" : ": " + session.message()));
  print_parts(console, session);
  print_trials(console, session);
  print_results(console, session);
  print_markers(console, session);
  print_corrections(console, session);
}

std::string correction_text(const v1::Correction& correction) {
  std::string what = correction.field() == "subject" ? "subject ID" : correction.field();
  if (correction.field() == "outcome") {
    what += " of trial " + std::to_string(correction.trial()) + ", attempt " + std::to_string(correction.attempt());
    if (correction.part() > 1) what += ", part " + std::to_string(correction.part());
  }
  if (correction.field() == "marker") {
    what += " " + std::to_string(correction.marker());
    if (correction.part() > 1) what += " of part " + std::to_string(correction.part());
  }
  const auto value = [](const std::string& text) { return text.empty() ? std::string("none") : text; };
  return what + ": " + value(correction.old_value()) + " -> " + value(correction.new_value()) + ", " + utc_text(correction.utc_ns()) +
         " UTC, " + correction.who() + (correction.reason().empty() ? "" : ": " + correction.reason());
}

void print_protocols(cli::Console& console, const v1::ListProtocolsResponse& protocols) {
  cli::Table table({"PROTOCOL", ">TRIALS", ">LENGTH", "WHAT"});
  for (const v1::ProtocolInfo& protocol : protocols.protocols()) {
    table.add({{protocol.name(), cli::Style::Bold},
               {protocol.trials() > 0 ? std::to_string(protocol.trials()) : "-"},
               {protocol.length_s() > 0.0 ? cli::duration(protocol.length_s()) : "-"},
               {protocol.sentence()}});
  }
  if (protocols.protocols_size() == 0) console.out << "no protocol is configured\n";
  table.print(console);
}

void print_protocol(cli::Console& console, const v1::ProtocolInfo& protocol) {
  print_field(console, "protocol", protocol.name());
  print_field(console, "title", protocol.title());
  print_field(console, "what", protocol.sentence());
  if (protocol.settle_s() > 0.0) print_field(console, "settling", cli::duration(protocol.settle_s()));
  print_field(console, "length", length_text(protocol));
  if (protocol.trials() > 0) print_field(console, "trials", std::to_string(protocol.trials()));
  cli::Table conditions({"CONDITION", "NAME", "TARGET"});
  for (const v1::ProtocolCondition& condition : protocol.conditions()) {
    conditions.add({{condition.name(), cli::Style::Bold}, {condition.title()}, {target_text(condition)}});
  }
  if (protocol.conditions_size() > 0) console.out << '\n';
  conditions.print(console);
  cli::Table fields({"FIELD", "NAME", "NEEDED", "VALUES", "WHAT"});
  for (const v1::ProtocolField& field : protocol.fields()) {
    std::string values = cli::join(field.choices(), " or ");
    if (values.empty()) values = shortest(field.minimum()) + " .. " + shortest(field.maximum());
    if (!field.unit().empty()) values += " " + field.unit();
    fields.add({{field.name(), cli::Style::Bold}, {field.label()}, {field.is_required() ? "yes" : "no"}, {values}, {field.help()}});
  }
  if (protocol.fields_size() > 0) console.out << '\n';
  fields.print(console);
}

void print_audit(cli::Console& console, const v1::GetAuditResponse& audit) {
  cli::Table table({">NUMBER", "TIME (UTC)", "WHO", "WHAT", "ON", "RESULT"});
  for (const v1::AuditEntry& entry : audit.entries()) {
    table.add({{std::to_string(entry.number())},
               {utc_text(entry.utc_ns())},
               {entry.who()},
               {entry.what()},
               {or_dash(entry.target())},
               {entry.result(), entry.result() == "ok" ? cli::Style::Plain : cli::Style::Warning}});
  }
  table.print(console);
  if (!audit.problem().empty()) return;
  console.out << audit.verified_entries() << (audit.verified_entries() == 1 ? " entry" : " entries") << ", unchanged\n";
}

}  // namespace dts::ctl
