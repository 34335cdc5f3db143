// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <memory>
#include <numeric>

#include "lab/reach/trial_pipeline.h"
#include "lab/reach/trial_set.h"
#include "pipeline/main_reach.h"

namespace dts::lab::reach {

/// Each trial is a separate segment, because it is a separate recording: its result does not depend on the other trials.
std::vector<std::optional<core::ReachEvent>> find_reaches(const TrialSet& set, const std::function<void(double)>& progress) {
  std::vector<std::optional<core::ReachEvent>> found(set.trials.size());
  std::map<std::pair<std::int64_t, std::int64_t>, std::unique_ptr<TrialPipeline>> pipelines;  // by rate
  const double scans = std::accumulate(set.trials.begin(), set.trials.end(), 0.0,
                                       [](double sum, const Trial& trial) { return sum + static_cast<double>(trial.volts.size()); });
  double done = 0.0;
  for (std::size_t k = 0; k < set.trials.size(); ++k) {
    const Trial& trial = set.trials[k];
    auto& pipeline = pipelines[{trial.rate.numerator(), trial.rate.denominator()}];
    if (!pipeline) {
      auto created = TrialPipeline::create(set.rig, trial.rate);
      if (!created) continue;  // the extractor does not support this rate: no reach
      pipeline = std::move(*created);
    }
    found[k] = pipeline::main_reach(pipeline->watch(trial.volts).events);
    done += static_cast<double>(trial.volts.size());
    if (progress) progress(done / scans);
  }
  return found;
}

}  // namespace dts::lab::reach
