// SPDX-License-Identifier: Apache-2.0
#include "fhir/observations.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "core/join.h"
#include "core/utf8.h"
#include "dts/wire/options.h"
#include "record/old_event.h"
#include "report/measure_tables.h"
#include "report/page_parts.h"
#include "report/result_names.h"
#include "session/session_events.h"

namespace dts::fhir {
namespace {

using posturography::Measure;

constexpr std::string_view kRombergGroup = "romberg";
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Adds components to an Observation, in order.
class Components {
 public:
  explicit Components(Json& observation) : observation_(observation) {}

  void integer(std::string_view code, std::uint32_t value) { add(code)["valueInteger"] = value; }
  void boolean(std::string_view code, bool value) { add(code)["valueBoolean"] = value; }
  void text(std::string_view code, const std::string& value) { add(code)["valueString"] = core::printable(value); }
  void coded(std::string_view code, std::string_view value) { add(code)["valueCodeableConcept"] = concept_of(value); }
  void absent(std::string_view code, Absent reason, const std::string& why) { add(code)["dataAbsentReason"] = absent_reason(reason, why); }
  /// A value that is not finite is absent.
  void number(std::string_view code, double value, const std::string& unit) {
    if (!std::isfinite(value)) return absent(code, Absent::NotApplicable, "not defined for this trial");
    add(code)["valueQuantity"] = quantity(value, unit);
  }
  void number(std::string_view code, double value) { number(code, value, find_code(code)->unit); }
  void range(std::string_view code, double low, double high) {
    const std::string& unit = find_code(code)->unit;
    if (!std::isfinite(low) || !std::isfinite(high) || low > high)
      return absent(code, Absent::NotApplicable, "the model gives no interval");
    add(code)["valueRange"] = {{"low", quantity(low, unit)}, {"high", quantity(high, unit)}};
  }

 private:
  Json& add(std::string_view code) {
    observation_["component"].push_back({{"code", concept_of(code)}});
    return observation_["component"].back();
  }

  Json& observation_;
};

Resource begin_observation(const RecordedPart& part, const About& about, const std::string& what, std::string_view code,
                           std::string_view status, const Period& period) {
  Resource resource = begin_resource(part, "Observation", what);
  add_identifier(resource);
  Json& json = resource.json;
  json["status"] = status;
  json["category"] = list_of({{"coding", list_of({{"system", "http://terminology.hl7.org/CodeSystem/observation-category"},
                                                  {"code", "procedure"},
                                                  {"display", "Procedure"}})}});
  json["code"] = concept_of(code);
  json["subject"] = reference_to(about.patient_id);
  if (Json when = period_json(period); !when.is_null()) json["effectivePeriod"] = std::move(when);
  json["device"] = reference_to(about.device_id);
  return resource;
}

void add_note(Json& observation, const std::string& text) { observation["note"].push_back({{"text", core::printable(text)}}); }

std::string why_not_valid(v1::TrialFault fault, const v1::Event& result) {
  const std::string problem = result.has_sway() ? result.sway().problem() : "";
  return "the trial is not valid: " + (problem.empty() ? report::fault_words(fault) : problem);
}

void add_standing(const session::SwayTrialResult& result, Json& observation) {
  Components components(observation);
  const posturography::Analysis& analysis = *result.analysis;
  observation["method"]["text"] =
      "Centre of pressure, " + std::string(posturography::name(analysis.profile)) + ": " + report::filter_text(analysis);
  components.number("duration_s", analysis.duration_s);
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    const std::string_view symbol = posturography::info(measure).symbol;
    if (const auto value = analysis.measures.get(measure)) {
      components.number(symbol, *value);
    } else if (measure != Measure::ApUse) {  // dtsd does not compute it; the report does
      components.absent(symbol, Absent::NotApplicable, report::why_absent(measure, analysis));
    }
  }
  for (std::uint32_t bit = 0; bit < posturography::sway_flag::kCount; ++bit) {
    if ((analysis.flags & (1U << bit)) != 0) add_note(observation, std::string(posturography::sentence_of(1U << bit)));
  }
}

/// Returns the code of a trunk class; empty for a rejected reach, or for a number that this version does not know.
std::string_view code_of(int trunk_class) {
  switch (trunk_class) {
    case 0: return "trunk-none";
    case 1: return "trunk-minor";
    case 2: return "trunk-moderate";
    case 3: return "trunk-maximum";
    default: return "";
  }
}

std::string words_of(const google::protobuf::EnumDescriptor& type, std::uint32_t bits) {
  std::vector<std::string> words;
  for (std::uint32_t bit = 0; bit < 31; ++bit) {
    const std::uint32_t flag = 1U << bit;
    if ((bits & flag) != 0) words.push_back(wire::enumerator_word(type, static_cast<int>(flag)));
  }
  return core::join(words);
}

void add_movement(const v1::TrialResult& result, Components& components) {
  const auto none = [&](Absent why, const std::string& text) {
    for (const std::string_view code : {"trunk-class", "trunk_deg", "trunk-interval90_deg"}) components.absent(code, why, text);
  };
  if (!result.has_reach()) return none(Absent::NotApplicable, "no reach was found in the trial");
  if (!result.has_movement()) return none(Absent::Unknown, "the rig has no model");
  const v1::TrunkMovement& movement = result.movement();
  const std::string_view code = code_of(movement.trunk_class());
  if (code.empty()) {
    const bool is_of_the_reach = (movement.reasons() & v1::CLASS_REASON_BAD_REACH) != 0 && result.reach().flags() != 0;
    const std::string why = is_of_the_reach
                                ? words_of(*v1::ReachFlag_descriptor(), result.reach().flags())
                                : words_of(*v1::ClassReason_descriptor(), movement.reasons() & ~std::uint32_t{v1::CLASS_REASON_CALIBRATED});
    return none(Absent::Unknown, "the reach was rejected" + (why.empty() ? "" : ": " + why));
  }
  const bool is_small = movement.trunk_class() == 1 && (movement.reasons() & v1::CLASS_REASON_MINOR) != 0;
  components.coded("trunk-class", is_small ? "trunk-none-or-minor" : code);
  if (movement.has_trunk_deg() && std::isfinite(movement.trunk_deg())) {
    components.number("trunk_deg", movement.trunk_deg());
  } else {
    components.absent("trunk_deg", Absent::NotApplicable, "the model gives no angle");
  }
  const bool has_interval = movement.has_trunk_lo_deg() && movement.has_trunk_hi_deg();
  components.range("trunk-interval90_deg", has_interval ? movement.trunk_lo_deg() : kUnknown, movement.trunk_hi_deg());
}

/// Reads the message itself: results of dtsd 0.1 lack fields of later versions, and have values all the same.
void add_reaching(const v1::TrialResult& result, Json& observation) {
  Components components(observation);
  components.boolean("reach-found", result.has_reach());
  add_movement(result, components);
  if (const std::string_view expected = code_of(result.expected_class()); result.has_expected_class() && !expected.empty())
    components.coded("expected-trunk-class", expected);
  if (!result.has_reach()) return;
  const v1::Reach& reach = result.reach();
  const auto put = [&](std::string_view code, bool is_known, double value) {
    if (is_known && std::isfinite(value)) return components.number(code, value);
    components.absent(code, Absent::Unknown, "not recorded");
  };
  put("p1_mm", reach.has_p1(), reach.p1().value_mm());
  put("p2_mm", reach.has_p2(), reach.p2().value_mm());
  put("p3_mm", reach.has_p3(), reach.p3().value_mm());
  put("d1_mm", reach.has_d1_mm(), reach.d1_mm());
  put("d2_mm", reach.has_d2_mm(), reach.d2_mm());
  put("rise_s", reach.has_rise_s(), reach.rise_s());
  put("sparc", reach.has_smoothness(), reach.smoothness());
  if (const std::string flags = words_of(*v1::ReachFlag_descriptor(), reach.flags()); !flags.empty())
    add_note(observation, "The reach has flags: " + flags);
}

void add_context(const RecordedTrial& trial, const v1::Event& result, Json& observation) {
  Components components(observation);
  components.integer("part", trial.row.part);
  components.integer("trial-number", trial.row.trial);
  components.integer("attempt", trial.row.attempt);
  if (!trial.row.condition.empty()) components.text("condition", trial.row.condition);
  std::map<std::string, std::string> labels;
  for (const auto& [name, value] : result.sway().labels()) labels.emplace(name, value);
  for (const auto& [name, value] : labels) components.text(core::printable(name), value);
  if (result.has_trial_result() && result.trial_result().has_target_cm()) components.number("target_cm", result.trial_result().target_cm());
}

void add_reaching_arm(const RecordedPart& part, Json& observation) {
  const auto side = std::ranges::find(part.facts.fields, "side", &std::pair<std::string, std::string>::first);
  if (part.facts.kind != "chair" || side == part.facts.fields.end()) return;
  const bool is_an_arm = side->second == "left" || side->second == "right";  // another text may name a person
  if (is_an_arm) Components(observation).text("reaching-arm", side->second);
}

/// Adds the values of a trial that counts.
core::Status add_values(const v1::Event& result, Json& observation) {
  if (const v1::TrialFault fault = record::fault_of(result); fault != v1::TRIAL_FAULT_UNSPECIFIED) {
    observation["dataAbsentReason"] = absent_reason(Absent::Error, why_not_valid(fault, result));
    return {};
  }
  if (result.has_sway()) {
    DTS_TRY_ASSIGN(const auto standing, session::sway_of(result));
    if (standing.analysis) {
      add_standing(standing, observation);
      return {};
    }
  } else if (result.has_trial_result()) {
    add_reaching(result.trial_result(), observation);
    return {};
  }
  observation["dataAbsentReason"] = absent_reason(Absent::Unknown, "no result of this trial was recorded");
  return {};
}

std::string_view status_of(const RecordedPart& part, const RecordedTrial& trial) {
  if (trial.is_withdrawn()) return "entered-in-error";
  // dtsd did not record results at the end of this part: the bundle and its PDF have computed them.
  if (part.is_interrupted) return "preliminary";
  return trial.is_corrected || part.has_corrected_subject ? "amended" : "final";
}

core::Result<Resource> trial_observation(const RecordedPart& part, const RecordedTrial& trial, const About& about) {
  v1::Event result;
  if (!trial.row.result.empty()) {
    auto read = record::event_of_text(trial.row.result);
    if (!read) {
      return core::fail(core::ErrorCode::DataDamaged, "the result of trial " + std::to_string(trial.row.trial) + " cannot be read",
                        "check the recording: dtsctl session verify " + part.facts.session_id);
    }
    result = std::move(*read);
  }
  const std::string_view code = result.has_sway() ? "standing-trial" : result.has_trial_result() ? "reaching-trial" : "trial";
  const std::string_view status = status_of(part, trial);
  const std::string what = "trial/" + std::to_string(trial.row.trial) + "/" + std::to_string(trial.row.attempt);
  Resource resource = begin_observation(part, about, what, code, status, trial.period);
  add_context(trial, result, resource.json);
  add_reaching_arm(part, resource.json);
  if (trial.is_withdrawn()) {
    // Without values: some receivers ignore the status.
    resource.json["dataAbsentReason"] =
        absent_reason(Absent::Error, "withdrawn: the outcome of the trial was corrected to '" + core::printable(trial.row.outcome) + "'");
    return resource;
  }
  DTS_TRY(add_values(result, resource.json));
  return resource;
}

bool is_romberg(const std::string& group) { return group == kRombergGroup || group.starts_with(std::string(kRombergGroup) + "/"); }

/// Returns the code of a group of results; the group itself, which is no code, for one that this version does not know.
std::string_view group_code(const std::string& group, bool has_trials) {
  if (group.empty()) return "session-summary";
  if (is_romberg(group)) return "romberg-quotient";
  return has_trials ? std::string_view("condition-mean") : std::string_view(group);
}

/// Returns what limits a result: "about 64 kg, corrected for two feet without a stance width". Empty: nothing.
std::string note_of(const record::ResultRow& row) {
  const Json details = Json::parse(row.details, nullptr, false);
  const auto note = details.is_object() ? details.find("note") : details.end();
  return note != details.end() && note->is_string() ? note->get<std::string>() : std::string();
}

/// Results of the session that belong together: of one condition, of one stance, or of the whole session.
Resource result_observation(const RecordedPart& part, const About& about, const std::string& group,
                            const std::vector<record::ResultRow>& rows, const std::vector<std::string>& trial_ids) {
  const std::string_view code = group_code(group, !trial_ids.empty());
  const bool is_amended = part.has_corrected_outcomes || part.has_corrected_subject;
  Resource resource = begin_observation(part, about, "result/" + group, code, is_amended ? "amended" : "final", part.period);
  Components components(resource.json);
  components.integer("part", record::leading_part(part.facts));
  if (!group.empty())
    components.text("condition", is_romberg(group) ? group.substr(std::min(group.size(), kRombergGroup.size() + 1)) : group);
  add_reaching_arm(part, resource.json);
  for (const record::ResultRow& row : rows) {
    const std::string symbol = report::parts_of(row.name).symbol;
    components.number(is_romberg(group) ? std::string(kRombergPrefix) + symbol : symbol, row.value, row.unit);
    if (const std::string note = note_of(row); !note.empty()) add_note(resource.json, symbol + ": " + note);
  }
  for (const std::string& id : trial_ids) resource.json["derivedFrom"].push_back(reference_to(id));
  return resource;
}

bool has_stance(const v1::Event& result, const std::string& group) {
  std::string_view rest = std::string_view(group).substr(std::min(group.size(), kRombergGroup.size() + 1));
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    const std::size_t equals = pair.find('=');
    const auto label = result.sway().labels().find(std::string(pair.substr(0, equals)));
    if (equals == std::string_view::npos || label == result.sway().labels().end() || label->second != pair.substr(equals + 1)) return false;
  }
  return true;
}

/// Returns the ids of the valid trials from which the results of a group were computed. A trial that a gap cut short is in the results of
/// its condition only if the condition has no whole one.
std::vector<std::string> sources_of(const std::vector<std::pair<const RecordedTrial*, std::string>>& trials, const std::string& group) {
  struct Source {
    std::string condition;
    std::string id;
    bool is_cut = false;
  };
  std::vector<Source> sources;
  std::set<std::string> has_whole;  // conditions
  for (const auto& [trial, id] : trials) {
    if (!record::is_valid(trial->row)) continue;
    const auto result = record::event_of_text(trial->row.result);
    const bool belongs = group.empty() || trial->row.condition == group || (is_romberg(group) && result && has_stance(*result, group));
    if (!belongs) continue;
    const bool is_cut = !group.empty() && result && (result->sway().flags() & v1::SWAY_FLAG_CUT_AT_GAP) != 0;
    sources.push_back({trial->row.condition, id, is_cut});
    if (!is_cut) has_whole.insert(trial->row.condition);
  }
  std::vector<std::string> ids;
  for (const Source& source : sources) {
    if (!source.is_cut || !has_whole.contains(source.condition)) ids.push_back(source.id);
  }
  return ids;
}

}  // namespace

core::Result<PartObservations> observations_of(const RecordedPart& part, const About& about) {
  PartObservations observations;
  std::vector<std::pair<const RecordedTrial*, std::string>> kept;
  for (const RecordedTrial& trial : part.trials) {
    DTS_TRY_ASSIGN(auto resource, trial_observation(part, trial, about));
    if (trial.is_withdrawn()) {
      observations.withdrawn.push_back(std::move(resource));
      continue;
    }
    kept.emplace_back(&trial, resource.id);
    observations.trials.push_back(std::move(resource));
  }
  std::map<std::string, std::vector<record::ResultRow>> groups;
  for (const record::ResultRow& row : part.results) groups[report::parts_of(row.name).group].push_back(row);
  for (const auto& [group, rows] : groups) {
    observations.results.push_back(result_observation(part, about, group, rows, sources_of(kept, group)));
  }
  return observations;
}

}  // namespace dts::fhir
