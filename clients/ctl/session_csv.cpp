// SPDX-License-Identifier: Apache-2.0
#include "ctl/session_csv.h"

#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "cli/console.h"
#include "ctl/recording_view.h"
#include "report/decision_words.h"
#include "report/result_names.h"

namespace dts::ctl {
namespace {

/// One value of a trial.
struct Value {
  std::string measure;
  std::string name;
  double value = 0.0;
  std::string unit;
};

class Values {
 public:
  void add(std::string_view measure, std::string_view name, std::optional<double> value, std::string_view unit) {
    if (value && std::isfinite(*value)) all.push_back({std::string(measure), std::string(name), *value, std::string(unit)});
  }
  std::vector<Value> all{};
};

std::optional<double> if_known(bool is_known, double value) { return is_known ? std::optional(value) : std::nullopt; }

std::vector<Value> standing_values(const v1::TrialRecord& trial) {
  Values values;
  for (const v1::SwayMeasure& measure : trial.sway().measures()) {
    values.add(measure.symbol(), report::plain_name(measure.symbol()), measure.value(), measure.unit());
  }
  const v1::SteadinessDecision* decision = report::kept_decision(trial);
  if (decision == nullptr || decision->outcome() != v1::DECISION_OUTCOME_DECIDED) return values.all;
  const std::string limits = cli::join(report::decision_limits(*decision), " ");
  for (const v1::GroupProbability& group : decision->probabilities()) {
    const std::string name = "Probability of " + group.group() + " by the steadiness model of " + decision->label() + " (" +
                             report::decision_text(*decision) + "). " + limits;
    values.add("p_" + group.group(), name, group.probability(), "1");
  }
  return values.all;
}

std::vector<Value> values_of(const v1::TrialResult& result) {
  const v1::Reach& reach = result.reach();
  const v1::TrunkMovement& movement = result.movement();
  Values values;
  values.add("target_cm", "Distance of the target from the acromion", if_known(result.has_target_cm(), result.target_cm()), "cm");
  values.add("p1_mm", "Seat deflection at the onset (P1)", if_known(reach.has_p1(), reach.p1().value_mm()), "mm");
  values.add("p2_mm", "Seat deflection at the dip (P2)", if_known(reach.has_p2(), reach.p2().value_mm()), "mm");
  values.add("p3_mm", "Seat deflection at the peak (P3)", if_known(reach.has_p3(), reach.p3().value_mm()), "mm");
  values.add("d1_mm", "Dip (P1 - P2)", if_known(reach.has_d1_mm(), reach.d1_mm()), "mm");
  values.add("d2_mm", "Rise (P3 - P1)", if_known(reach.has_d2_mm(), reach.d2_mm()), "mm");
  values.add("hold_mm", "Mean of the hold, less P1", if_known(reach.has_hold_mm(), reach.hold_mm()), "mm");
  values.add("rise_s", "Time from P2 to P3", if_known(reach.has_rise_s(), reach.rise_s()), "s");
  values.add("smoothness", "Spectral arc length, nearer 0 is smoother", if_known(reach.has_smoothness(), reach.smoothness()), "1");
  values.add("trunk_class", "Trunk class: 0 none, 1 minor, 2 moderate, 3 maximum, -1 rejected",
             if_known(result.has_movement(), movement.trunk_class()), "1");
  values.add("expected_class", "Trunk class that is expected for this target",
             if_known(result.has_expected_class(), result.expected_class()), "1");
  values.add("trunk_deg", "Trunk flexion at P3", if_known(movement.has_trunk_deg(), movement.trunk_deg()), "deg");
  values.add("trunk_lo_deg", "Trunk flexion, 90 % interval, low end", if_known(movement.has_trunk_lo_deg(), movement.trunk_lo_deg()),
             "deg");
  values.add("trunk_hi_deg", "Trunk flexion, 90 % interval, high end", if_known(movement.has_trunk_hi_deg(), movement.trunk_hi_deg()),
             "deg");
  return values.all;
}

std::string row_of(const std::vector<std::string>& cells) {
  std::string row;
  for (const std::string& cell : cells) row += (row.empty() ? "" : ",") + cli::csv_cell(cell);
  return row + "\n";
}

}  // namespace

std::string trials_csv(const v1::SessionRecord& session) {
  std::string text = "session_id,subject,protocol,part,trial,attempt,condition,outcome,fault,is_valid,measure,name,value,unit\n";
  for (const v1::TrialRecord& trial : session.trials()) {
    const bool is_valid = trial.outcome() == "done" && trial.fault() == v1::TRIAL_FAULT_UNSPECIFIED;
    const std::vector<std::string> about{session.session_id(),
                                         session.subject(),
                                         session.protocol(),
                                         std::to_string(trial.part()),
                                         std::to_string(trial.trial()),
                                         std::to_string(trial.attempt()),
                                         trial.condition(),
                                         trial.outcome(),
                                         report::fault_words(trial.fault()),
                                         is_valid ? "1" : "0"};
    std::vector<Value> values = trial.has_sway() ? standing_values(trial) : values_of(trial.result());
    const auto add = [&](std::vector<std::string> cells) {
      cells.insert(cells.begin(), about.begin(), about.end());
      text += row_of(cells);
    };
    for (const Value& value : values) add({value.measure, value.name, shortest(value.value), value.unit});
    if (values.empty()) add({"", "", "", ""});
  }
  return text;
}

}  // namespace dts::ctl
