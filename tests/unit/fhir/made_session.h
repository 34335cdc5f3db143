// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "fhir/codes.h"
#include "record/catalogue/corrections.h"
#include "session/session_events.h"
#include "unit/report/made_standing.h"

namespace dts::fhir {

inline const std::string kSession = "20261121T144525Z-floor-1";  // NOLINT(cert-err58-cpp)

/// The event with the result of a trial of standing that has these measures.
inline v1::Event sway_event(std::uint32_t trial, const std::string& condition,
                            const std::vector<std::pair<std::string, std::string>>& labels,
                            const std::vector<std::pair<posturography::Measure, double>>& values, std::uint32_t flags = 0) {
  session::SwayTrialResult result{.trial = trial, .condition = condition, .labels = labels, .analysis = posturography::Analysis{}};
  result.analysis->rate_hz = 100.0;
  result.analysis->samples = 2000;
  result.analysis->duration_s = 20.0;
  result.analysis->flags = flags;
  for (const auto& [measure, value] : values) result.analysis->measures.set(measure, value);
  return session::to_event(result, kSession, "dtsd 0.2.0");
}

/// Trial 1 with eyes open from 2 s to 22 s, trial 2 with eyes closed from 25 s to 45 s, and results of the session.
inline report::MadeStanding made_session() {
  const std::vector<std::pair<std::string, std::string>> open{{"eyes", "open"}, {"feet", "two"}};
  const std::vector<std::pair<std::string, std::string>> closed{{"eyes", "closed"}, {"feet", "two"}};
  report::MadeStanding made{.length_s = 50.0};
  report::add_trial(made, 1, 2.0, 20.0, "eyes-open", open);
  report::add_trial(made, 2, 25.0, 20.0, "eyes-closed", closed);
  using posturography::Measure;
  made.events = {sway_event(1, "eyes-open", open, {{Measure::Mvelo, 8.3812345678}, {Measure::Pea95F, 120.5}}),
                 sway_event(2, "eyes-closed", closed, {{Measure::Mvelo, 12.25}}, posturography::sway_flag::kMissingSamples),
                 session::to_event(session::SessionFigure{.name = "eyes-open/MVELO", .value = 8.3812345678, .unit = "mm/s"}),
                 session::to_event(session::SessionFigure{.name = "eyes-closed/MVELO", .value = 12.25, .unit = "mm/s"}),
                 session::to_event(session::SessionFigure{.name = "romberg/feet=two/MVELO", .value = 1.4616, .unit = "1"})};
  for (v1::Event& event : made.events) event.set_scan(4900);
  return made;
}

/// A reach of trial 3 to a target at 120 cm.
inline session::ReachTrialResult made_reach(core::TrunkClass trunk_class, std::uint16_t reasons = 0) {
  core::ReachEvent reach{.step = core::ReachStep::Final, .number = 1};
  reach.features = {.p1_mm = 3.5, .p2_mm = 2.75, .p3_mm = 5.0, .rise_s = 0.5, .smoothness = -2.0};
  reach.p1.value_mm = 3.5;
  reach.p2.value_mm = 2.75;
  reach.p3.value_mm = 5.0;
  core::TrunkMovement movement{.trunk_class = trunk_class, .trunk_deg = 30.5, .trunk_lo_deg = 22.0, .trunk_hi_deg = 38.0};
  movement.reasons = reasons;
  return {.trial = 3, .condition = "120", .target_cm = 120.0, .reach = reach, .movement = movement, .expected = core::TrunkClass::Moderate};
}
inline report::MadeStanding made_reaching(const session::ReachTrialResult& result) {
  report::MadeStanding made{.length_s = 20.0, .has_cop = false};
  made.facts.kind = "chair";
  report::add_trial(made, 3, 2.0, 10.0, "120", {});
  made.events = {session::to_event(result, kSession)};
  made.events.front().set_scan(1900);
  return made;
}

/// Corrects the outcome of attempt 1 of a trial.
inline void correct_outcome(const std::string& recording, std::uint32_t trial, const std::string& outcome) {
  record::Corrections corrections{.session_id = kSession};
  corrections.add({.utc_ns = 1'795'300'000'000'000'000,
                   .who = "local",
                   .field = record::CorrectedField::Outcome,
                   .part = 1,
                   .trial = trial,
                   .attempt = 1,
                   .old_value = "done",
                   .new_value = outcome,
                   .reason = "test"});
  ASSERT_TRUE(record::write_corrections(record::corrections_file(recording, kSession), corrections));
}

/// Returns the resources of a type.
inline std::vector<Json> resources_of(const Json& bundle, const std::string& type) {
  std::vector<Json> found;
  for (const Json& entry : bundle.at("entry")) {
    if (entry.at("resource").at("resourceType") == type) found.push_back(entry.at("resource"));
  }
  return found;
}
inline std::string code_of(const Json& concept_json) {
  return concept_json.contains("coding") ? concept_json.at("coding").at(0).at("code").get<std::string>()
                                         : concept_json.at("text").get<std::string>();
}
/// Returns the component with this code; null without one.
inline Json component(const Json& observation, const std::string& code) {
  for (const Json& one : observation.value("component", Json::array())) {
    if (code_of(one.at("code")) == code) return one;
  }
  return nullptr;
}
/// Returns the first Observation with this code whose component `by` has the value; null without one.
inline Json observation_of(const Json& bundle, const std::string& code, const std::string& by = "", const Json& value = nullptr) {
  for (const Json& one : resources_of(bundle, "Observation")) {
    if (code_of(one.at("code")) != code) continue;
    if (by.empty()) return one;
    const Json found = component(one, by);
    if (!found.is_null() && (found.value("valueInteger", Json()) == value || found.value("valueString", Json()) == value)) return one;
  }
  return nullptr;
}

}  // namespace dts::fhir
