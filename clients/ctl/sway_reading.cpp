// SPDX-License-Identifier: Apache-2.0
#include "ctl/sway_reading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cli/table.h"
#include "ctl/json.h"
#include "report/decision_words.h"

namespace dts::ctl {
namespace {

struct Shown {
  const char* name;
  const char* symbol;
  int decimals;
};
constexpr std::array<Shown, 4> kShown{
    {{"velocity", "MVELO", 2}, {"distance", "RDIST", 2}, {"ellipse", "PEA95_F", 1}, {"range AP", "RANGE_AP", 1}}};

}  // namespace

std::optional<double> measure_value(const v1::Sway& sway, std::string_view symbol) {
  const auto found = std::ranges::find_if(sway.measures(), [&](const v1::SwayMeasure& measure) { return measure.symbol() == symbol; });
  if (found == sway.measures().end() || !std::isfinite(found->value())) return std::nullopt;
  return found->value();
}

std::string sway_flag_words(const v1::Sway& sway) { return cli::join(bit_words(*v1::SwayFlag_descriptor(), sway.flags()), " "); }

std::string sway_text(const v1::Sway& sway) {
  std::string text = sway.is_preliminary() ? "preliminary, " : "";
  if (sway.is_preliminary() && sway.trial() == 0) text += "no trial, ";
  if (sway.trial() > 0) text += "trial " + std::to_string(sway.trial()) + (sway.attempt() > 1 ? "." + std::to_string(sway.attempt()) : "");
  if (!sway.condition().empty()) text += " (" + sway.condition() + ")";
  if (sway.trial() > 0) text += ", ";
  if (!sway.problem().empty()) return text + "no values: " + sway.problem();
  std::vector<std::string> values;
  for (const Shown& shown : kShown) {
    const auto found = std::ranges::find(sway.measures(), shown.symbol, &v1::SwayMeasure::symbol);
    if (found == sway.measures().end()) continue;
    values.push_back(shown.name + (" (" + found->symbol()) + ") " + cli::decimal(found->value(), shown.decimals) + " " + found->unit());
  }
  if (values.empty()) values.emplace_back(sway.is_preliminary() ? "no values yet" : "no values");
  if (sway.window() == v1::SWAY_WINDOW_LATEST) text += "last ";
  text += cli::decimal(sway.duration_s(), 1) + " s: " + cli::join(values, "  ");
  const std::string flags = sway_flag_words(sway);
  if (!flags.empty()) text += "  [" + flags + "]";
  if (!sway.is_valid() && !sway.is_preliminary()) text += "  INVALID";
  if (sway.has_decision())
    text += "  " + report::decision_text(sway.decision()) + ". " + cli::join(report::decision_limits(sway.decision()), " ");
  return text;
}

}  // namespace dts::ctl
