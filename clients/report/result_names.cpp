// SPDX-License-Identifier: Apache-2.0
#include "report/result_names.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "report/measure_tables.h"
#include "report/page_parts.h"
#include "session/figure.h"

namespace dts::report {
namespace {

constexpr std::string_view kRombergGroup = "romberg";

/// Results that are no measures of steadiness.
constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kOthers{
    {{"load_n", "Load while standing"},
     {"trials", "Trials done"},
     {"targets", "Targets"},
     {"reaches_detected_share", "Trials with a reach, share of 1"},
     {"rejected_share", "Reaches without a trunk class, share of 1"},
     {"class_agreement_share", "Trunk class as expected, share of 1"},
     {"trunk_at_critical_boundary_deg", "Trunk angle at the limit of the arm's reach"},
     {"trunk_sd_deg", "Trunk angle, SD within a target"},
     {"d2_sd_mm", "Rise of the seat (d2), SD within a target"},
     {"sparc_mean", "Smoothness of the reach, nearer 0 is smoother"}}};

std::string group_text(const std::string& group) {
  if (group != kRombergGroup && !group.starts_with(std::string(kRombergGroup) + "/")) return group;
  const std::string stance = group == kRombergGroup ? "" : group.substr(kRombergGroup.size() + 1);
  return "Romberg quotient" + (stance.empty() ? "" : ", " + stance_text(stance));
}

}  // namespace

ResultName parts_of(const std::string& name) {
  const auto [whole, part] = session::without_part_suffix(name);
  const std::size_t slash = whole.rfind('/');
  if (slash == std::string::npos) return {.group = "", .symbol = whole, .part = part};
  return {.group = whole.substr(0, slash), .symbol = whole.substr(slash + 1), .part = part};
}

std::string fault_words(v1::TrialFault fault) {
  switch (fault) {
    case v1::TRIAL_FAULT_STEPPED_OFF: return "stepped off";
    case v1::TRIAL_FAULT_FEET_MOVED: return "feet moved";
    case v1::TRIAL_FAULT_NO_REACH: return "no reach";
    case v1::TRIAL_FAULT_NO_VALUES: return "no values";
    default: return "";
  }
}

std::string plain_name(const std::string& symbol) {
  if (const auto measure = posturography::measure_named(symbol)) {
    std::string name = measure_name(*measure);
    const std::size_t bracket = name.find(" (" + symbol.substr(0, symbol.find('_')));  // some names have their symbol
    return bracket == std::string::npos ? name : name.substr(0, bracket);
  }
  const auto known = std::ranges::find(kOthers, symbol, &std::pair<std::string_view, std::string_view>::first);
  return known == kOthers.end() ? symbol : std::string(known->second);
}

std::string result_label(const std::string& name) {
  const ResultName parts = parts_of(name);
  const std::string plain = plain_name(parts.symbol);
  std::string label = parts.group.empty() ? plain : group_text(parts.group) + ": " + plain;
  if (plain != parts.symbol) label += " (" + parts.symbol + ")";
  return label + (parts.part > 1 ? ", part " + std::to_string(parts.part) : "");
}

}  // namespace dts::report
