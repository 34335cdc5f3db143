// SPDX-License-Identifier: Apache-2.0
#include "ctl/reach_reading.h"

#include <cmath>

#include "cli/table.h"
#include "ctl/json.h"

namespace dts::ctl {
namespace {

std::string number_text(double value, int decimals) { return std::isfinite(value) ? cli::decimal(value, decimals) : "-"; }

std::string in_brackets(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "  [" : " ") + word;
  return text.empty() ? text : text + "]";
}

/// Returns " (18.1 .. 32.4)"; nothing if the interval is not known.
std::string interval_text(const v1::TrunkMovement& movement) {
  if (!movement.has_trunk_lo_deg() || !movement.has_trunk_hi_deg()) return {};
  return " (" + number_text(movement.trunk_lo_deg(), 1) + " .. " + number_text(movement.trunk_hi_deg(), 1) + ")";
}

/// Returns "moderate trunk movement, p 0.97, trunk 25.2 deg (18.1 .. 32.4)".
std::string class_text(const v1::TrunkMovement& movement, std::uint32_t reach_flags) {
  const std::string amount = movement.trunk_class() == 0 ? "no" : class_words(movement, reach_flags);
  std::string text = amount + (movement.trunk_class() < 0 ? "" : " trunk movement");
  if (movement.trunk_class() > 0 && movement.trunk_class() <= movement.probability_size()) {  // not always the highest
    text += ", p " + number_text(movement.probability(movement.trunk_class() - 1), 2);
  }
  if (movement.has_trunk_deg() && std::isfinite(movement.trunk_deg())) {
    text += ", trunk " + number_text(movement.trunk_deg(), 1) + " deg" + interval_text(movement);
  }
  return text + in_brackets(bit_words(*v1::ClassReason_descriptor(), movement.reasons()));
}

}  // namespace

std::string class_word(int trunk_class) {
  switch (trunk_class) {
    case 0: return "none";
    case 1: return "minor";
    case 2: return "moderate";
    case 3: return "maximum";
    default: return "rejected";
  }
}

std::string class_words(const v1::TrunkMovement& movement, std::uint32_t reach_flags) {
  const std::uint32_t reasons = movement.reasons();
  if (movement.trunk_class() == 1 && (reasons & v1::CLASS_REASON_MINOR) != 0) return "none or minor";
  if (movement.trunk_class() >= 0) return class_word(movement.trunk_class());
  const bool is_of_the_reach = (reasons & v1::CLASS_REASON_BAD_REACH) != 0 && reach_flags != 0;
  const auto words = is_of_the_reach ? bit_words(*v1::ReachFlag_descriptor(), reach_flags)
                                     : bit_words(*v1::ClassReason_descriptor(), reasons & ~std::uint32_t{v1::CLASS_REASON_CALIBRATED});
  const std::string why = cli::join(words);
  return class_word(movement.trunk_class()) + (why.empty() ? "" : " (" + why + ")");
}

std::string point_text(bool is_known, const v1::ReachPoint& point) { return is_known ? number_text(point.value_mm(), 2) : "-"; }

std::string probabilities_text(const v1::TrunkMovement& movement) {
  std::string text;
  for (const double probability : movement.probability()) text += (text.empty() ? "" : " ") + number_text(probability, 2);
  return text.empty() ? "-" : text;
}

std::string degrees_text(const v1::TrunkMovement& movement) {
  if (movement.trunk_class() < 0 || !movement.has_trunk_deg() || !std::isfinite(movement.trunk_deg())) return "-";
  return number_text(movement.trunk_deg(), 1) + interval_text(movement);
}

std::string reach_text(const v1::Reach& reach) {
  std::string text = "reach " + std::to_string(reach.number()) + " " + enumerator_word(*v1::ReachStep_descriptor(), reach.step());
  if (reach.step() == v1::REACH_STEP_CANCELLED) return text;
  text += ": P1 " + point_text(reach.has_p1(), reach.p1()) + "  P2 " + point_text(reach.has_p2(), reach.p2()) + "  P3 " +
          point_text(reach.has_p3(), reach.p3()) + " mm";
  return text + in_brackets(bit_words(*v1::ReachFlag_descriptor(), reach.flags()));
}

std::string movement_text(const v1::TrunkMovement& movement) {
  return "reach " + std::to_string(movement.number()) + ": " + class_text(movement, 0);
}

std::string trial_result_text(const v1::TrialResult& result) {
  const std::string trial = "result of trial " + std::to_string(result.trial()) + " (" + result.condition() + "): ";
  if (result.has_gap()) return trial + "no result: scans are missing";
  if (!result.has_reach() && result.has_expected_class() && result.expected_class() == 0) {
    return trial + "no reach found; as expected for this target";
  }
  if (!result.has_movement()) return trial + (result.has_reach() ? "a reach, not classified" : "no reach found");
  const bool is_comparable = result.has_expected_class() && result.expected_class() >= 0 && result.movement().trunk_class() >= 0;
  const bool agrees = result.expected_class() == result.movement().trunk_class();
  const std::string expected = !is_comparable ? ""
                               : agrees       ? "; as expected for this target"
                                              : "; expected for this target: " + class_word(result.expected_class());
  return trial + class_text(result.movement(), result.reach().flags()) + expected;
}

}  // namespace dts::ctl
