// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/reach_plot.h"

#include <cmath>
#include <set>

#include "lab/base/plot.h"
#include "lab/reach/trial_pipeline.h"

namespace dts::lab::reach {

core::Status plot_reaches(const TrialSet& set, const std::vector<std::optional<core::ReachEvent>>& reaches, const std::string& file) {
  CurvePlot plot{.title = "Transients of reaches, with P1, P2 and P3",
                 .x_label = "time from the trial's first sample (s)",
                 .y_label = "transient (mm)",
                 .curves = {},
                 .is_from_zero = false};
  Curve points{.name = "P1, P2, P3", .points = {}, .style = CurveStyle::Points};
  std::set<std::string> drawn;
  for (std::size_t k = 0; k < set.trials.size(); ++k) {
    const Trial& trial = set.trials[k];
    if (!drawn.insert(trial.condition).second) continue;
    DTS_TRY_ASSIGN(auto pipeline, TrialPipeline::create(set.rig, trial.rate));
    const std::string name = set.subjects[trial.subject].name + " " + std::to_string(trial.number) + ": " + trial.condition;
    plot.curves.push_back({.name = name, .points = pipeline->watch(trial.volts).transient, .style = CurveStyle::Lines});
    if (!reaches[k]) continue;
    for (const core::ReachPoint& point : {reaches[k]->p1, reaches[k]->p2, reaches[k]->p3}) {
      if (std::isfinite(point.value_mm))
        points.points.emplace_back(static_cast<double>(point.scan.value) / trial.rate.hz(), point.value_mm);
    }
  }
  if (!points.points.empty()) plot.curves.push_back(std::move(points));
  return draw_curves(plot, file);
}

}  // namespace dts::lab::reach
