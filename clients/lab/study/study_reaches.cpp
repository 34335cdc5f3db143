// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study_reaches.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "lab/reach/simulated_trials.h"
#include "lab/reach/trial_set.h"
#include "lab/training/random.h"

namespace dts::lab::study {
namespace {

using core::TrunkClass;

constexpr int kTrialsPerTarget = 15;     // thesis 5.3.1 and 6.3.3
constexpr double kSimulationPart = 0.4;  // fraction of the time; the rest is for the extractor

enum class Use : std::uint64_t { Teachers = 1, Healthy, Stroke };

/// Volunteers of another group must be other people: the simulator draws them by seed and index.
std::uint64_t seed_of(const Volunteer& first, std::uint64_t seed) {
  const Use use = !first.is_healthy ? Use::Stroke : first.measured_deg ? Use::Healthy : Use::Teachers;
  return training::derived_seed(seed, static_cast<std::uint64_t>(use));
}

std::vector<reach::Subject> subjects_of(std::span<const Volunteer> volunteers) {
  std::vector<reach::Subject> subjects;
  for (const Volunteer& volunteer : volunteers) {
    subjects.push_back({.name = std::string(volunteer.name), .is_healthy = volunteer.is_healthy, .person = volunteer.person});
  }
  return subjects;
}

/// After a stroke the angle defines the class, even if the target equals one of the others' targets.
TrunkClass wanted_of(const reach::Trial& trial, const Volunteer& volunteer) {
  return volunteer.is_healthy ? reach::class_of_condition(trial.condition).value_or(TrunkClass::None) : volunteer.boundary_class;
}

/// Runs the daemon's stages on simulated volts.
StudyGroup found(std::span<const Volunteer> volunteers, const reach::SimulatedTrials& simulated, const Progress& progress) {
  StudyGroup group{.volunteers = {volunteers.begin(), volunteers.end()}, .reaches = {}};
  const auto reaches = reach::find_reaches(simulated.set, progress);
  for (std::size_t k = 0; k < reaches.size(); ++k) {
    const reach::Trial& trial = simulated.set.trials[k];
    group.reaches.push_back({.volunteer = trial.subject,
                             .condition = trial.condition,
                             .wanted = wanted_of(trial, volunteers[trial.subject]),
                             .flexion_deg = simulated.trunk_deg[k],
                             .reach = reaches[k]});
  }
  return group;
}

core::Result<StudyGroup> simulate(std::span<const Volunteer> volunteers, const reach::TrialPlan& plan, const Progress& progress) {
  DTS_TRY_ASSIGN(const auto simulated,
                 reach::simulate_trials(subjects_of(volunteers), plan, [&](double done) { progress(kSimulationPart * done); }));
  return found(volunteers, simulated, [&](double done) { progress(kSimulationPart + (1.0 - kSimulationPart) * done); });
}

/// Returns the mean flexion in `trials` reaches to each target; targets in percent of the arm.
core::Result<std::vector<double>> probe_deg(const reach::Subject& subject, const std::vector<int>& percents, int trials,
                                            std::uint64_t seed) {
  reach::TrialPlan plan{.conditions = {}, .trials_per_condition = trials, .seed = seed, .has_volts = false};
  for (const int percent : percents) plan.conditions.push_back(std::to_string(percent));
  DTS_TRY_ASSIGN(const auto probes, reach::simulate_trials({subject}, plan, [](double) {}));
  std::vector<double> means(percents.size());
  for (std::size_t k = 0; k < probes.trunk_deg.size(); ++k) {
    means[k / static_cast<std::size_t>(trials)] += probes.trunk_deg[k] / static_cast<double>(trials);
  }
  return means;
}

/// Returns the target at which this simulated person bends the trunk by the angle that the thesis measured at the critical boundary. The
/// target differs from the printed distance, because it is random how much the trunk compensates for a weak arm. Searches first coarsely,
/// then around the best target with more reaches.
core::Result<std::string> boundary_of(const reach::Subject& subject, double wanted_deg, std::uint64_t seed) {
  int best = 115;
  for (const auto& [reach_percent, step_percent, trials] : {std::tuple(60, 10, 2), std::tuple(9, 3, 8)}) {
    std::vector<int> percents;
    for (int percent = best - reach_percent; percent <= best + reach_percent; percent += step_percent) percents.push_back(percent);
    DTS_TRY_ASSIGN(const auto means_deg, probe_deg(subject, percents, trials, seed));
    const auto nearest = std::ranges::min_element(means_deg, {}, [&](double mean_deg) { return std::abs(mean_deg - wanted_deg); });
    best = percents[static_cast<std::size_t>(nearest - means_deg.begin())];
  }
  return std::to_string(best);
}

}  // namespace

training::TrainingSet training_set(const std::vector<const StudyGroup*>& groups) {
  training::TrainingSet set;
  for (const StudyGroup* group : groups) {
    const std::size_t first = set.subjects.size();
    for (const Volunteer& volunteer : group->volunteers) {
      set.subjects.push_back({.name = std::string(volunteer.name),
                              .max_flexion_deg = physics::trunk_flexion_deg(volunteer.person, volunteer.person.max_reach_cm)});
    }
    for (const StudyReach& one : group->reaches) {
      if (!one.reach) continue;
      set.reaches.push_back({.subject = first + one.volunteer,
                             .features = one.reach->features,
                             .flags = one.reach->flags,
                             .wanted = one.wanted,
                             .flexion_deg = one.flexion_deg});
    }
  }
  return set;
}

core::Result<StudyGroup> natural_reaches(std::span<const Volunteer> volunteers, Targets targets, std::uint64_t seed,
                                         const Progress& progress) {
  // The targets within reach are last, so that the other trials are the same with and without them.
  reach::TrialPlan plan{.conditions = {"120", "150", "max"}, .trials_per_condition = kTrialsPerTarget};
  if (targets == Targets::All) plan.conditions.insert(plan.conditions.end(), {"80", "100"});
  plan.seed = seed_of(volunteers.front(), seed);
  return simulate(volunteers, plan, progress);
}

core::Result<StudyGroup> boundary_reaches(std::span<const Volunteer> volunteers, std::uint64_t seed, const Progress& progress) {
  std::vector<reach::Subject> subjects = subjects_of(volunteers);
  reach::SimulatedTrials all;
  for (std::size_t place = 0; place < subjects.size(); ++place) {
    reach::Subject& subject = subjects[place];
    subject.person.max_reach_cm = 2.0 * subject.person.arm_length_cm;  // limit of the probes, not of the volunteer
    const std::uint64_t own_seed = training::derived_seed(seed_of(volunteers[place], seed), place);
    DTS_TRY_ASSIGN(const auto boundary, boundary_of(subject, volunteers[place].boundary_deg.value_or(0.0), own_seed));
    const reach::TrialPlan plan{.conditions = {boundary}, .trials_per_condition = kTrialsPerTarget, .seed = own_seed};
    DTS_TRY_ASSIGN(auto one, reach::simulate_trials({subject}, plan, [](double) {}));
    all.set.rig = std::move(one.set.rig);
    for (std::size_t k = 0; k < one.set.trials.size(); ++k) {
      all.trunk_deg.push_back(one.trunk_deg[k]);
      all.set.trials.push_back(std::move(one.set.trials[k]));
      all.set.trials.back().subject = place;
    }
    progress(kSimulationPart * static_cast<double>(place + 1) / static_cast<double>(subjects.size()));
  }
  all.set.subjects = std::move(subjects);
  return found(volunteers, all, [&](double done) { progress(kSimulationPart + (1.0 - kSimulationPart) * done); });
}

core::Result<StudyGroup> ideal_reaches(std::span<const Volunteer> volunteers, std::span<const double> paces_s, int repetitions) {
  const reach::TrialPlan plan{.trials_per_condition = repetitions * static_cast<int>(paces_s.size()),
                              .paces_s = {paces_s.begin(), paces_s.end()},
                              .is_ideal = true};
  return simulate(volunteers, plan, [](double) {});
}

}  // namespace dts::lab::study
