// SPDX-License-Identifier: Apache-2.0
#include "fhir/codes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <utility>

#include "posturography/measure.h"
#include "report/result_names.h"

namespace dts::fhir {
namespace {

using posturography::Measure;

constexpr std::string_view kUcum = "http://unitsofmeasure.org";
constexpr int kDigits = 6;

struct Unit {
  std::string_view ours;
  std::string_view ucum;
  std::string_view shown;
};
constexpr std::array<Unit, 13> kUnits{{{"mm", "mm", "mm"},
                                       {"cm", "cm", "cm"},
                                       {"mm/s", "mm/s", "mm/s"},
                                       {"mm2", "mm2", "mm²"},
                                       {"mm2/s", "mm2/s", "mm²/s"},
                                       {"1/mm", "/mm", "1/mm"},
                                       {"Hz", "Hz", "Hz"},
                                       {"s", "s", "s"},
                                       {"deg", "deg", "°"},
                                       {"deg/s", "deg/s", "°/s"},
                                       {"N", "N", "N"},
                                       {"%", "%", "%"},
                                       {"1", "1", "1"}}};

struct FixedCode {
  std::string_view code;
  std::string_view display;
  std::string_view unit{};
};
constexpr std::array<FixedCode, 7> kObservations{{{"standing-trial", "Trial of quiet standing"},
                                                  {"reaching-trial", "Trial of the reaching task"},
                                                  {"trial", "Trial without a recorded result"},
                                                  {"condition-mean", "Means over the valid trials of one condition"},
                                                  {"romberg-quotient", "Romberg quotients: mean with eyes closed over mean with eyes open"},
                                                  {"session-summary", "Results over the valid trials of the session"},
                                                  {"session-report", "Report of a session"}}};
constexpr std::array<FixedCode, 7> kContext{{{"part", "Part of the session, from 1"},
                                             {"trial-number", "Number of the trial in the session's plan, from 1"},
                                             {"attempt", "Attempt of the trial, from 1"},
                                             {"condition", "Condition of the protocol"},
                                             {"duration_s", "Duration of the analysed measurement", "s"},
                                             {"target_cm", "Distance of the target from the acromion", "cm"},
                                             {"reach-found", "Whether a reach was found in the trial"}}};
constexpr std::array<FixedCode, 16> kReaches{
    {{"p1_mm", "P1: deflection of the seat where the reach begins", "mm"},
     {"p2_mm", "P2: deflection of the seat at the end of the reach initiation stage", "mm"},
     {"p3_mm", "P3: largest deflection of the seat in the reach", "mm"},
     {"d1_mm", "d1: P1 minus P2", "mm"},
     {"d2_mm", "d2: P3 minus P1", "mm"},
     {"rise_s", "Time from P2 to P3", "s"},
     {"sparc", "Smoothness of the reach: spectral arc length from P1 to P3, nearer 0 is smoother", "1"},
     {"trunk-class", "Trunk class of the reach"},
     {"expected-trunk-class", "Trunk class expected for the target and the subject's measures"},
     {"trunk_deg", "Trunk flexion at P3, estimated by the rig's model", "deg"},
     {"trunk-interval90_deg", "Limits of the 90 % interval of the trunk flexion", "deg"},
     {"trunk-none", "No trunk movement"},
     {"trunk-none-or-minor", "No or minor trunk movement: the reach is too small to distinguish them"},
     {"trunk-minor", "Minor trunk movement"},
     {"trunk-moderate", "Moderate trunk movement"},
     {"trunk-maximum", "Maximum trunk movement"}}};
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kSessionResults{{{"load_n", "N"},
                                                                                         {"trials", "1"},
                                                                                         {"targets", "1"},
                                                                                         {"reaches_detected_share", "1"},
                                                                                         {"rejected_share", "1"},
                                                                                         {"class_agreement_share", "1"},
                                                                                         {"trunk_at_critical_boundary_deg", "deg"},
                                                                                         {"trunk_sd_deg", "deg"},
                                                                                         {"d2_sd_mm", "mm"},
                                                                                         {"sparc_mean", "1"}}};

template <std::size_t Count>
void add(const std::array<FixedCode, Count>& fixed, std::vector<Code>& codes) {
  for (const FixedCode& one : fixed)
    codes.push_back({.code = std::string(one.code), .display = std::string(one.display), .unit = std::string(one.unit)});
}

std::vector<Code> make_codes() {
  std::vector<Code> codes;
  add(kObservations, codes);
  add(kContext, codes);
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto& about = posturography::info(static_cast<Measure>(index));
    codes.push_back({.code = std::string(about.symbol), .display = std::string(about.sentence), .unit = std::string(about.unit)});
  }
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto& about = posturography::info(static_cast<Measure>(index));
    if (!about.is_core || !about.is_ratio_scaled) continue;
    codes.push_back({.code = std::string(kRombergPrefix) + std::string(about.symbol),
                     .display = "Romberg quotient of: " + std::string(about.sentence),
                     .unit = "1"});
  }
  add(kReaches, codes);
  for (const auto& [code, unit] : kSessionResults) {
    codes.push_back({.code = std::string(code), .display = report::plain_name(std::string(code)), .unit = std::string(unit)});
  }
  return codes;
}

double rounded(double value) {
  std::array<char, 32> text{};
  const auto [end, failed] = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, kDigits);
  double result = value;
  if (failed == std::errc()) std::from_chars(text.data(), end, result);
  return result;
}

}  // namespace

Json list_of(Json one) {
  Json list = Json::array();
  list.push_back(std::move(one));
  return list;
}

const std::vector<Code>& all_codes() {
  static const std::vector<Code> codes = make_codes();
  return codes;
}

const Code* find_code(std::string_view code) {
  static const std::map<std::string_view, const Code*> places = [] {
    std::map<std::string_view, const Code*> map;
    for (const Code& one : all_codes()) map.emplace(one.code, &one);
    return map;
  }();
  const auto found = places.find(code);
  return found == places.end() ? nullptr : found->second;
}

Json concept_of(std::string_view code) {
  const Code* const known = find_code(code);
  if (known == nullptr) return {{"text", code}};
  return {{"coding", list_of({{"system", kCodeSystem}, {"code", known->code}, {"display", known->display}})}};
}

Json quantity(double value, const std::string& unit) {
  const auto* const known = std::ranges::find(kUnits, unit, &Unit::ours);
  Json json{{"value", rounded(value)}};
  if (known == kUnits.end()) {
    if (!unit.empty()) json["unit"] = unit;
    return json;
  }
  json["unit"] = known->shown;
  json["system"] = kUcum;
  json["code"] = known->ucum;
  return json;
}

std::optional<std::string_view> ucum_of(std::string_view unit) {
  const auto* const known = std::ranges::find(kUnits, unit, &Unit::ours);
  return known == kUnits.end() ? std::nullopt : std::optional(known->ucum);
}

Json absent_reason(Absent reason, const std::string& text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kReasons{
      {{"not-applicable", "Not Applicable"}, {"unknown", "Unknown"}, {"error", "Error"}}};
  const auto& [code, display] = kReasons[static_cast<std::size_t>(reason)];
  Json json{
      {"coding", list_of({{"system", "http://terminology.hl7.org/CodeSystem/data-absent-reason"}, {"code", code}, {"display", display}})}};
  if (!text.empty()) json["text"] = text;
  return json;
}

std::string code_system_text() {
  Json concepts = Json::array();
  for (const Code& one : all_codes()) {
    Json entry{{"code", one.code}, {"display", one.display}};
    if (!one.unit.empty()) entry["property"] = list_of({{"code", "unit"}, {"valueString", ucum_of(one.unit).value_or(one.unit)}});
    concepts.push_back(std::move(entry));
  }
  const Json json{
      {"resourceType", "CodeSystem"},
      {"id", kCodeSystem.substr(kCodeSystem.rfind(':') + 1)},
      {"url", kCodeSystem},
      {"name", "DtsdCodes"},
      {"title", "Codes of dtsd for postural steadiness and reaching"},
      {"status", "active"},
      {"experimental", false},
      {"description",
       "Local codes of dtsd. No code of LOINC or SNOMED CT is claimed for them. The documentation of dtsd defines each measure."},
      {"caseSensitive", true},
      {"content", "complete"},
      {"property", list_of({{"code", "unit"}, {"description", "Unit of the value, as a UCUM code"}, {"type", "string"}})},
      {"concept", std::move(concepts)}};
  return json.dump(1) + "\n";
}

}  // namespace dts::fhir
