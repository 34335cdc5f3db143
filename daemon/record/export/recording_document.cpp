// SPDX-License-Identifier: Apache-2.0
#include "record/export/recording_document.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "core/number_text.h"
#include "core/utc_text.h"
#include "dts/wire/options.h"
#include "record/export/row_text.h"
#include "record/losses.h"

namespace dts::record {
namespace {

using Json = nlohmann::ordered_json;

Json correction_json(const Correction& correction, bool has_texts) {
  Json json{{"utc", core::utc_text(correction.utc_ns)}, {"field", name(correction.field)}};
  if (correction.field == CorrectedField::Outcome) {
    json["part"] = correction.part;
    json["trial"] = correction.trial;
    json["attempt"] = correction.attempt;
  }
  if (correction.field == CorrectedField::Marker) {
    json["part"] = correction.part;
    json["marker"] = correction.marker;
  }
  if (has_texts || !is_text(correction.field)) {
    json["old_value"] = correction.old_value;
    json["new_value"] = correction.new_value;
  }
  if (!has_texts) return json;
  json["who"] = correction.who;
  json["reason"] = correction.reason;
  return json;
}

Json session_json(const SessionFacts& recorded, const Corrections& corrections, bool has_texts) {
  const SessionFacts facts = corrected(recorded, corrections);
  Json json{{"session_id", facts.session_id}, {"part", facts.part}};
  const auto put = [&json](const char* key, const std::string& text) {
    if (!text.empty()) json[key] = text;
  };
  put("rig", facts.rig);
  if (!facts.rigs.empty()) json["rigs"] = facts.rigs;
  if (facts.leading_part != 0) json["leading_part"] = facts.leading_part;
  put("kind", facts.kind);
  put("protocol", facts.protocol);
  put("subject", facts.subject);
  if (facts.subject != recorded.subject) json["recorded_subject"] = recorded.subject;
  if (has_texts) put("label", facts.label);
  const bool is_label_shown = has_texts && !corrections.has_removed(CorrectedField::Label);
  if (is_label_shown && facts.label != recorded.label) json["recorded_label"] = recorded.label;
  if (const std::string* notes = corrections.value(CorrectedField::Notes); has_texts && notes != nullptr) put("notes", *notes);
  for (const Correction& correction : corrections.all) json["corrections"].push_back(correction_json(correction, has_texts));
  for (const auto& [name, value] : facts.fields) json["subject_fields"][name] = value;
  if (facts.started_utc_ns > 0) json["started_utc"] = core::utc_text(facts.started_utc_ns);
  put("software", facts.software);
  put("device_uri", facts.device_uri);
  put("device_model", facts.device_model);
  put("device_serial", facts.device_serial);
  put("firmware", facts.firmware);
  put("calibration_id", facts.calibration_id);
  if (!facts.stages.empty()) json["stages"] = facts.stages;
  return json;
}

Json stream_json(const Recording& recording, std::size_t stream) {
  const StreamInfo& info = recording.streams()[stream];
  Json json{{"name", info.name}, {"samples", recording.sample_count(stream)}};
  if (info.rate) json["rate_hz"] = info.rate->hz();
  json["filter_delay_s"] = static_cast<double>(info.delay_ns) * 1e-9;
  for (const ChannelInfo& channel : info.channels) json["channels"].push_back({{"label", channel.label}, {"unit", channel.unit}});
  return json;
}

/// The cells of a trial's result, by the names of their columns.
using ResultCells = std::vector<std::pair<std::string, std::string>>;

/// Adds a decision with what must be known to read it.
void add_cells(const v1::SteadinessDecision& decision, ResultCells& cells) {
  std::string outcome = wire::enumerator_word(*v1::DecisionOutcome_descriptor(), decision.outcome());
  std::ranges::replace(outcome, '_', ' ');
  cells.emplace_back("decision", std::move(outcome));
  if (decision.outcome() == v1::DECISION_OUTCOME_DECIDED) {  // the more probable group of another trial says nothing
    for (const v1::GroupProbability& group : decision.probabilities())
      cells.emplace_back("p_" + group.group() + " [1]", core::number_text(group.probability()));
  }
  cells.emplace_back("model", decision.label());
  cells.emplace_back("model_people", std::to_string(decision.people()));
  cells.emplace_back("model_condition", decision.condition());
  cells.emplace_back("model_auc [1]", core::number_text(decision.auc()));
  cells.emplace_back("model_auc_low [1]", core::number_text(decision.auc_low()));
  cells.emplace_back("model_auc_high [1]", core::number_text(decision.auc_high()));
  cells.emplace_back("best_measure", decision.best_measure());
  cells.emplace_back("best_measure_auc [1]", core::number_text(decision.best_measure_auc()));
  cells.emplace_back("rival", decision.rival());
  if (decision.has_rival_auc()) cells.emplace_back("rival_auc [1]", core::number_text(decision.rival_auc()));
  cells.emplace_back("decision_limit", "No statement about health or risk of falling.");
}

void add_cells(const v1::Sway& sway, bool is_kept, ResultCells& cells) {
  if (sway.has_duration_s()) cells.emplace_back("duration_s", core::number_text(sway.duration_s()));
  for (const v1::SwayMeasure& measure : sway.measures()) {
    cells.emplace_back(measure.symbol() + " [" + measure.unit() + "]", core::number_text(measure.value()));
  }
  if (is_kept && sway.has_decision()) add_cells(sway.decision(), cells);
}

void add_cells(const v1::TrialResult& result, ResultCells& cells) {
  if (result.has_target_cm()) cells.emplace_back("target_cm", core::number_text(result.target_cm()));
  const v1::Reach& reach = result.reach();
  if (reach.has_p1()) cells.emplace_back("p1_mm", core::number_text(reach.p1().value_mm()));
  if (reach.has_p2()) cells.emplace_back("p2_mm", core::number_text(reach.p2().value_mm()));
  if (reach.has_p3()) cells.emplace_back("p3_mm", core::number_text(reach.p3().value_mm()));
  if (!result.has_movement()) return;
  const v1::TrunkMovement& movement = result.movement();
  cells.emplace_back("trunk_class", std::to_string(movement.trunk_class()));
  if (movement.has_trunk_deg()) cells.emplace_back("trunk_deg", core::number_text(movement.trunk_deg()));
  if (movement.has_trunk_lo_deg()) cells.emplace_back("trunk_lo_deg", core::number_text(movement.trunk_lo_deg()));
  if (movement.has_trunk_hi_deg()) cells.emplace_back("trunk_hi_deg", core::number_text(movement.trunk_hi_deg()));
}

ResultCells cells_of(const TrialRow& trial) {
  ResultCells cells;
  const auto event = event_of_text(trial.result);
  if (!event) return cells;
  const v1::TrialFault fault = fault_of(*event);
  const bool is_faulty = fault != v1::TRIAL_FAULT_UNSPECIFIED;
  cells.emplace_back("fault", is_faulty ? wire::enumerator_word(*v1::TrialFault_descriptor(), fault) : "");
  if (event->has_sway()) add_cells(event->sway(), trial.outcome == "done", cells);
  if (event->has_trial_result()) add_cells(event->trial_result(), cells);
  return cells;
}

}  // namespace

std::string recording_document(const Recording& recording, const Corrections& corrections, bool has_texts) {
  Json json = session_json(recording.session().value_or(SessionFacts{}), corrections, has_texts);
  const core::LossCount lost = recording.losses().total();
  json["duration_s"] = recording.duration_s();
  json["lost_scans"] = lost.scans;
  json["gaps"] = lost.gaps;
  json["losses"] = Json::parse(to_json(recording.losses()));
  if (!recording.damage().empty()) json["damage"] = recording.damage();
  for (std::size_t stream = 0; stream < recording.streams().size(); ++stream) json["streams"].push_back(stream_json(recording, stream));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void TrialTable::add(const RecordedScans& scans) noexcept {
  if (raw_ != scans.stream || scans.count == 0) return;
  newest_.segment = scans.segment;
  newest_.first_scan = {scans.first_scan.value + (scans.count - 1)};
}

std::string TrialTable::text(const Corrections& corrections) {
  if (raw_) {
    newest_.stream = *raw_;
    newest_.count = 1;
    trials_.add(RecordedItem(newest_));
  }
  // Only a session with corrected outcomes has the column: the same recording without corrections gives the same bytes for ever.
  const bool is_corrected = std::ranges::find(corrections.all, CorrectedField::Outcome, &Correction::field) != corrections.all.end();
  std::vector<TrialRow> rows = trials_.rows();
  if (rows.empty()) return {};
  std::vector<std::string> recorded_outcomes;
  std::vector<std::string> columns{"fault"};  // always, then those of the results, as any trial has them
  for (TrialRow& trial : rows) {
    recorded_outcomes.push_back(trial.outcome);
    if (const std::string* outcome = corrections.outcome(part_, trial.trial, trial.attempt)) trial.outcome = *outcome;
    for (const auto& [name, cell] : cells_of(trial)) {
      if (std::ranges::find(columns, name) == columns.end()) columns.push_back(name);
    }
  }
  std::string text = "trial,attempt,block,condition,outcome,is_valid,first_segment,first_scan,last_segment,last_scan";
  if (is_corrected) text += ",recorded_outcome";
  for (const std::string& name : columns) text += "," + csv_cell(name);
  text += '\n';
  for (std::size_t index = 0; index < rows.size(); ++index) {
    const TrialRow& trial = rows[index];
    text += std::to_string(trial.trial) + "," + std::to_string(trial.attempt) + "," + std::to_string(trial.block) + "," +
            csv_cell(trial.condition) + "," + trial.outcome + "," + (is_valid(trial) ? "1" : "0") + "," + std::to_string(trial.segment) +
            "," + std::to_string(trial.first_scan) + "," + std::to_string(std::max(trial.segment, trial.last_segment)) + "," +
            std::to_string(trial.last_scan);
    if (is_corrected) text += "," + recorded_outcomes[index];
    const ResultCells cells = cells_of(trial);
    for (const std::string& name : columns) {
      const auto found = std::ranges::find(cells, name, &ResultCells::value_type::first);
      text += "," + (found == cells.end() ? std::string() : csv_cell(found->second));
    }
    text += '\n';
  }
  return text;
}

}  // namespace dts::record
