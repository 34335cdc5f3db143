// SPDX-License-Identifier: Apache-2.0
#include "report/chair_words.h"

#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "record/catalogue/catalogue.h"
#include "report/number_text.h"
#include "report/result_names.h"
#include "session/session_events.h"

namespace dts::report {
namespace {

namespace reason = core::class_reason;
namespace flag = core::reach_flag;
using Word = std::pair<std::uint16_t, std::string_view>;

constexpr std::array<Word, 6> kReasons{{{reason::kUnsure, "no class is probable enough"},
                                        {reason::kOutOfRange, "the reach is unlike all reaches of the model's training"},
                                        {reason::kBadReach, "the reach is doubtful"},
                                        {reason::kMinor, "minor reach: at most class minor"},
                                        {reason::kCalibrated, "classified on the subject's own scale"},
                                        {reason::kDisagreement, "class and angle contradict each other"}}};

constexpr std::array<Word, 11> kFlags{{{flag::kMinor, "minor reach: only the arm moved, or the posture shifted"},
                                       {flag::kBaselineUncertain, "not at rest before the reach"},
                                       {flag::kDipOnly, "reach incomplete: the load fell and did not rise"},
                                       {flag::kTimeout, "no return to rest"},
                                       {flag::kResumed, "continued after a pause"},
                                       {flag::kSubstituted, "a faulty sensor was estimated from the others"},
                                       {flag::kSaturated, "a sensor was at the limit of its range"},
                                       {flag::kImplausible, "the sensors contradict each other"},
                                       {flag::kStoodUp, "the person stood up"},
                                       {flag::kUntared, "the chair was not tared"},
                                       {flag::kNoInitiation, "no dip at the start: P2 equals P1"}}};

template <std::size_t Count>
std::vector<std::string> words_for(std::uint16_t bits, const std::array<Word, Count>& all) {
  std::vector<std::string> words;
  for (const auto& [bit, word] : all) {
    if ((bits & bit) != 0) words.emplace_back(word);
  }
  return words;
}

}  // namespace

std::string class_word(const std::optional<core::TrunkClass>& trunk_class) {
  if (!trunk_class) return "-";
  switch (*trunk_class) {
    case core::TrunkClass::Rejected: return "rejected";
    case core::TrunkClass::None: return "none";
    case core::TrunkClass::Minor: return "minor";
    case core::TrunkClass::Moderate: return "moderate";
    case core::TrunkClass::Maximum: return "maximum";
  }
  return "-";
}

std::string class_of(const ChairTrial& trial) {
  if (!trial.recorded.result) return "-";
  if (trial.recorded.result->has_gap) return "scans missing";
  if (trial.reach() == nullptr) return "no reach";
  if (trial.movement() == nullptr) return "-";
  // A minor reach is at most minor: the chair does not distinguish its trunk movement from none.
  const bool is_small = trial.movement()->trunk_class == core::TrunkClass::Minor && (trial.movement()->reasons & reason::kMinor) != 0;
  return is_small ? "none or minor" : class_word(trial.movement()->trunk_class);
}

std::vector<std::string> reason_words(std::uint16_t reasons) { return words_for(reasons, kReasons); }

std::vector<std::string> flag_words(std::uint16_t flags) { return words_for(flags, kFlags); }

std::string fault_of_reach(const ChairTrial& trial) {
  if (!trial.recorded.result) return "no values";
  return fault_words(record::fault_of(session::to_event(*trial.recorded.result, "")));
}

std::string outcome_of(const ChairTrial& trial) {
  const std::string& outcome = trial.recorded.outcome;
  std::string text = outcome;
  if (outcome != "done") text += ": not valid";
  if (const std::string fault = outcome == "done" ? fault_of_reach(trial) : ""; !fault.empty()) text += ", not valid: " + fault;
  return text + (trial.recorded_outcome.empty() ? "" : " (corrected; recorded: " + trial.recorded_outcome + ")");
}

std::string interval_text(const core::TrunkMovement& movement) {
  if (!std::isfinite(movement.trunk_lo_deg) || !std::isfinite(movement.trunk_hi_deg)) return "-";
  return fixed(movement.trunk_lo_deg, 1) + " to " + fixed(movement.trunk_hi_deg, 1);
}

}  // namespace dts::report
