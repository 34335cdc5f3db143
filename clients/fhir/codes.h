// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dts::fhir {

/// Members keep the order in which they were added, so that the same recording gives the same bytes.
using Json = nlohmann::ordered_json;
/// Returns an array of one element.
[[nodiscard]] Json list_of(Json one);

/// The code system of dtsd. dtsd owns no web address, so the name is a UUID: it belongs to nobody else, and nobody can take it away.
inline constexpr std::string_view kCodeSystem = "urn:uuid:2323a6c0-a61a-4a6a-b06a-cf420aa12e0a";

/// Before the symbol of a measure: its Romberg quotient. A quotient must not have the code of the measure itself.
inline constexpr std::string_view kRombergPrefix = "ROMBERG_";

/// A code of dtsd's own code system.
struct Code {
  std::string code;     ///< "MVELO_AP", "trunk_deg"
  std::string display;  ///< "Mean velocity: path length over duration, anterior-posterior"
  std::string unit{};   ///< As dtsd writes it: "mm2"; empty: the value is no number with a unit.
};
/// Returns every code, in the order of the documentation: observations, what they are about, measures of standing, reaches, results.
[[nodiscard]] const std::vector<Code>& all_codes();
/// Returns the code, or nullptr.
[[nodiscard]] const Code* find_code(std::string_view code);

/// Returns a CodeableConcept: one of our codes, or only the text if it is none (a result of another version).
[[nodiscard]] Json concept_of(std::string_view code);
/// Returns a Quantity with a UCUM code. A unit that dtsd does not use stands there as text, without a code. The value has 6 significant
/// digits: more would claim an accuracy that no rig has.
[[nodiscard]] Json quantity(double value, const std::string& unit);
/// Returns the UCUM code of a unit of dtsd: "mm2" for mm2, "/mm" for 1/mm; nothing for another unit.
[[nodiscard]] std::optional<std::string_view> ucum_of(std::string_view unit);

/// Why a value is absent: codes of FHIR's DataAbsentReason.
enum class Absent : std::uint8_t {
  NotApplicable,  ///< The value is not defined for this trial.
  Unknown,        ///< There is a value, but it is not known.
  Error,          ///< Something went wrong, so that the value does not count.
};
[[nodiscard]] Json absent_reason(Absent reason, const std::string& text);

/// Returns the code system as a FHIR resource, for the terminology server of a hospital.
[[nodiscard]] std::string code_system_text();

}  // namespace dts::fhir
