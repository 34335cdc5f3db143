// SPDX-License-Identifier: Apache-2.0
#include "lab/training/simulated_people.h"

#include <cmath>
#include <numbers>
#include <string>

#include "lab/reach/simulated_trials.h"
#include "lab/training/random.h"

namespace dts::lab::training {
namespace {

// The range of the volunteers of thesis Tables 5.1 and 6.1, slightly extended on each side.
constexpr double kLeastBodyMassIndex = 18.5;
constexpr double kLargestBodyMassIndex = 31.0;
constexpr double kArmOfHeight = 0.39;
constexpr double kArmSpread = 0.03;
constexpr double kLeastMaximumDeg = 44.0;
constexpr double kLargestMaximumDeg = 66.0;
constexpr double kTrunkOfHeight = 0.30;   // reach-model section 2
constexpr double kFingertipOfArm = 1.15;  // section 3
constexpr double kShoulderPartCm = 6.0;   // section 3: p

double uniform(Random& random, double middle, double spread) { return random.uniform(middle - spread, middle + spread); }

physics::Person invent(Random& random) {
  physics::Person person;
  const bool is_tall_sex = random.uniform(0.0, 1.0) < 0.5;
  person.height_cm = is_tall_sex ? uniform(random, 177.0, 13.0) : uniform(random, 163.0, 12.0);
  person.weight_kg = random.uniform(kLeastBodyMassIndex, kLargestBodyMassIndex) * person.height_cm * person.height_cm * 1e-4;
  person.arm_length_cm = uniform(random, kArmOfHeight, kArmSpread) * person.height_cm;
  const double sine = std::sin(random.uniform(kLeastMaximumDeg, kLargestMaximumDeg) * std::numbers::pi / 180.0);
  person.max_reach_cm = kFingertipOfArm * person.arm_length_cm + kTrunkOfHeight * person.height_cm * sine + kShoulderPartCm * sine * sine;
  return person;
}

}  // namespace

std::vector<reach::Subject> invent_people(std::size_t count, std::uint64_t seed) {
  std::vector<reach::Subject> people;
  Random random(derived_seed(seed, 77));
  while (people.size() < count) {
    const physics::Person person = invent(random);
    // A maximum reach is at least as far as 150 % of the arm.
    if (person.max_reach_cm < 1.6 * person.arm_length_cm) continue;
    people.push_back({.name = "sim" + std::to_string(people.size() + 1), .is_healthy = true, .person = person});
  }
  return people;
}

core::Result<TrainingSet> simulated_people(std::size_t count, int trials, std::uint64_t seed, const std::function<void(double)>& progress) {
  const auto report = [&](double part) {
    if (progress) progress(part);
  };
  const auto people = invent_people(count, seed);
  const reach::TrialPlan plan{.conditions = {"80", "100", "120", "150", "max"}, .trials_per_condition = trials, .seed = seed};
  DTS_TRY_ASSIGN(const auto simulated, reach::simulate_trials(people, plan, [&](double part) { report(part / 2.0); }));
  const auto reaches = reach::find_reaches(simulated.set, [&](double part) { report(0.5 + part / 2.0); });
  TrainingSet result;
  for (const reach::Subject& subject : people) {
    result.subjects.push_back({.name = subject.name,
                               .is_simulated = true,
                               .max_flexion_deg = physics::trunk_flexion_deg(subject.person, subject.person.max_reach_cm)});
  }
  for (std::size_t k = 0; k < reaches.size(); ++k) {
    const reach::Trial& trial = simulated.set.trials[k];
    const auto wanted = reach::class_of_condition(trial.condition);
    if (!reaches[k] || !wanted) continue;
    result.reaches.push_back({.subject = trial.subject,
                              .features = reaches[k]->features,
                              .flags = reaches[k]->flags,
                              .wanted = *wanted,
                              .flexion_deg = simulated.trunk_deg[k]});
  }
  return result;
}

TrainingSet joined(TrainingSet a, const TrainingSet& b) {
  const std::size_t offset = a.subjects.size();
  a.subjects.insert(a.subjects.end(), b.subjects.begin(), b.subjects.end());
  for (TrainingReach reach : b.reaches) {
    reach.subject += offset;
    a.reaches.push_back(reach);
  }
  return a;
}

}  // namespace dts::lab::training
