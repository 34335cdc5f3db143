// SPDX-License-Identifier: Apache-2.0
#include "lab/resolution/resolution.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lab/reach/simulated_trials.h"
#include "lab/training/random.h"
#include "lab/training/simulated_people.h"

namespace dts::lab::resolution {
namespace {

constexpr std::array kTurnsDeg = {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0, 15.0, 20.0};
constexpr const char* kTarget = "100";  // the farthest target that needs no trunk
constexpr int kNoneFactor = 3;          // the scatter without movement enters every limit
constexpr double kSimulationPart = 0.4;
constexpr std::uint64_t kOverPeople = 1'000'000;  // seed of the interval over people

/// The values of one person.
struct Values {
  std::array<Series, kAny> series;  ///< By measure.
  std::size_t found = 0;
  std::size_t all = 0;
};

/// Returns the values of the single measures.
std::array<double, kAny> values_of(const std::optional<core::ReachEvent>& reach) {
  if (!reach) return {};
  const core::ReachFeatures& features = reach->features;
  std::array values = {features.d2_mm() / features.p1_mm, features.ratio_change, features.d1_mm() / features.p1_mm};
  for (double& value : values) value = std::isfinite(value) ? value : 0.0;
  return values;
}

/// Adds the reaches of all people at one turn of the trunk.
core::Status add_turn(std::vector<Values>& people, const std::vector<reach::Subject>& subjects, const reach::TrialPlan& plan,
                      const std::function<void(double)>& progress) {
  DTS_TRY_ASSIGN(const auto simulated, reach::simulate_trials(subjects, plan, [&](double part) { progress(kSimulationPart * part); }));
  const auto reaches = reach::find_reaches(simulated.set, [&](double part) { progress(kSimulationPart + (1.0 - kSimulationPart) * part); });
  const double turn_deg = *plan.trunk_turn_deg;
  for (Values& person : people) {
    for (Series& series : person.series) {
      if (turn_deg > 0.0) series.levels.push_back({.turn_deg = turn_deg, .values = {}});
    }
  }
  for (std::size_t k = 0; k < reaches.size(); ++k) {
    Values& person = people[simulated.set.trials[k].subject];
    ++person.all;
    person.found += reaches[k] ? 1 : 0;
    const auto values = values_of(reaches[k]);
    for (std::size_t measure = 0; measure < values.size(); ++measure) {
      Series& series = person.series[measure];
      (turn_deg > 0.0 ? series.levels.back().values : series.none).push_back(values[measure]);
    }
  }
  return {};
}

PersonResolution result_of(const reach::Subject& subject, const Values& values, std::uint64_t seed) {
  PersonResolution result{.name = subject.name, .weight_kg = subject.person.weight_kg};
  result.missed_part = 1.0 - static_cast<double>(values.found) / static_cast<double>(values.all);
  const std::span<const Series> all(values.series);
  for (std::size_t measure = 0; measure < kMeasures; ++measure) {
    const auto series = measure == kAny ? all : all.subspan(measure, 1);
    for (std::size_t k = 0; k < kReaches.size(); ++k) result.limits[measure][k] = with_interval(series, kReaches[k], seed);
  }
  return result;
}

void summarise(Setup& setup, std::uint64_t seed) {
  for (std::size_t measure = 0; measure < kMeasures; ++measure) {
    for (std::size_t k = 0; k < kReaches.size(); ++k) {
      std::vector<Limit> limits;
      for (const PersonResolution& person : setup.people) limits.push_back(person.limits[measure][k].value);
      setup.medians[measure][k] = median_over_people(limits, seed);
      setup.worst_tenth[measure][k] = quantile(limits, 0.9);
    }
  }
}

core::Result<Setup> run_setup(const std::vector<reach::Subject>& subjects, const ResolutionOptions& options, double noise_mv,
                              double rate_hz, const std::function<void(double)>& progress) {
  std::vector<Values> values(subjects.size());
  constexpr double kBatches = static_cast<double>(kTurnsDeg.size()) + kNoneFactor;  // of `options.reaches` per person
  double done = 0.0;
  const auto add = [&](double turn_deg, int factor) {
    const reach::TrialPlan plan{.conditions = {kTarget},
                                .trials_per_condition = factor * options.reaches,
                                .rate_hz = rate_hz,
                                .noise_v = 1e-3 * noise_mv,
                                .trunk_turn_deg = turn_deg,
                                .seed = options.seed};
    auto added = add_turn(values, subjects, plan, [&](double part) { progress((done + factor * part) / kBatches); });
    done += factor;
    return added;
  };
  DTS_TRY(add(0.0, kNoneFactor));
  for (const double turn_deg : kTurnsDeg) DTS_TRY(add(turn_deg, 1));
  Setup setup{.noise_mv = noise_mv, .rate_hz = rate_hz, .people = {}};
  for (std::size_t person = 0; person < subjects.size(); ++person) {
    setup.people.push_back(result_of(subjects[person], values[person], training::derived_seed(options.seed, person)));
  }
  summarise(setup, training::derived_seed(options.seed, kOverPeople));
  return setup;
}

tl::unexpected<core::Error> refuse(const std::string& why) {
  return core::fail(core::ErrorCode::InvalidArgument, "cannot find the resolution: " + why);
}

core::Status check(const ResolutionOptions& options) {
  if (options.people < 1 || options.people > 1000) return refuse("the number of people is 1 to 1000");
  if (options.reaches < 5 || options.reaches > 1000) return refuse("the number of reaches is 5 to 1000");
  if (options.noises_mv.empty() || options.rates_hz.empty()) return refuse("there is no noise or no rate");
  return {};
}

}  // namespace

core::Result<Resolution> find_resolution(const ResolutionOptions& options, const std::function<void(double)>& progress) {
  DTS_TRY(check(options));
  const auto subjects = training::invent_people(options.people, options.seed);
  Resolution resolution{.seed = options.seed, .reaches = options.reaches, .setups = {}};
  double all = 0.0;  // the time is proportional to the scans
  for (const double rate_hz : options.rates_hz) all += rate_hz * static_cast<double>(options.noises_mv.size());
  double done = 0.0;
  for (const double noise_mv : options.noises_mv) {
    for (const double rate_hz : options.rates_hz) {
      DTS_TRY_ASSIGN(auto setup,
                     run_setup(subjects, options, noise_mv, rate_hz, [&](double part) { progress((done + rate_hz * part) / all); }));
      resolution.setups.push_back(std::move(setup));
      done += rate_hz;
    }
  }
  return resolution;
}

}  // namespace dts::lab::resolution
