// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/simulated_trials.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/chair_rig.h"
#include "sim/counter_random.h"
#include "sim/daq.h"
#include "sim/seat_plate.h"
#include "sim/seated_person.h"

namespace dts::lab::reach {
namespace {

constexpr std::size_t kTransientSensors = 4;
constexpr double kModelPhaseS = 0.75;  // thesis 5.4
constexpr double kIdealRestBeforeS = 1.5;
constexpr double kIdealRestAfterS = 1.2;
constexpr double kSatDownLongAgoS = -100.0;
constexpr double kLivingV = 1e-6;  // a thousandth of the noise: the stages treat constant volts as a stuck sensor
constexpr std::uint64_t kTrialsOfOneSubject = 1'000'000;
constexpr int kMostTrials = 10'000;

physics::RigModel transient_rig() {
  physics::RigModel rig = sim::chair_rig();
  const auto& used = *rig.transient_sensors;
  std::vector<physics::SensorModel> sensors;
  for (const std::size_t index : {used.rear[0], used.rear[1], used.front[0], used.front[1]}) sensors.push_back(rig.sensors[index]);
  rig.sensors = std::move(sensors);
  rig.transient_sensors = physics::RigModel::TransientSensors{.rear = {0, 1}, .front = {2, 3}};
  return rig;
}

tl::unexpected<core::Error> refuse(const std::string& why) {
  return core::fail(core::ErrorCode::InvalidArgument, "cannot simulate trials: " + why);
}

core::Status check(const std::vector<reach::Subject>& subjects, const TrialPlan& plan) {
  if (plan.trials_per_condition < 1 || plan.trials_per_condition > kMostTrials) return refuse("trials per condition are 1 to 10000");
  if (std::ranges::any_of(plan.paces_s, [](double pace_s) { return !(pace_s >= 0.3 && pace_s <= 10.0); })) {
    return refuse("a pace is 0.3 to 10 s");
  }
  if (!(plan.between_people >= 0.0 && plan.between_people <= 2.0)) return refuse("between_people is 0 to 2");
  if (!(plan.rate_hz >= 50.0 && plan.rate_hz <= 20'000.0)) return refuse("the rate is 50 to 20000 Hz");
  if (!(plan.noise_v >= 0.0 && plan.noise_v <= 1.0)) return refuse("the noise is 0 to 1 V");
  if (plan.trunk_turn_deg && !(*plan.trunk_turn_deg >= 0.0 && *plan.trunk_turn_deg <= 60.0)) return refuse("the trunk turns 0 to 60 deg");
  for (const reach::Subject& subject : subjects) {
    for (const std::string& condition : plan.conditions) {
      const auto target_cm = reach::target_cm(subject.person, condition);
      if (!target_cm || !std::isfinite(physics::trunk_flexion_deg(subject.person, *target_cm))) {
        return refuse("no target \"" + condition + "\" for " + subject.name);
      }
    }
  }
  return {};
}

/// One subject on the chair; performs one trial after the other.
class Sitter {
 public:
  static core::Result<Sitter> create(const reach::Subject& subject, std::size_t index, const TrialPlan& plan,
                                     const physics::RigModel& rig) {
    const std::uint64_t seed = plan.seed * kTrialsOfOneSubject * 1000 + index * kTrialsOfOneSubject;
    const sim::SittingHabits habits =
        plan.is_ideal ? sim::ideal_habits(subject.person, plan.load_model, kModelPhaseS)
                      : sim::natural_habits(subject.person, subject.is_healthy, plan.load_model, seed, plan.between_people);
    std::vector<physics::Point> probes;
    for (const physics::SensorModel& sensor : rig.sensors) {
      if (plan.has_volts) probes.push_back(sensor.position);
    }
    DTS_TRY_ASSIGN(auto plate, sim::SeatPlate::create(rig.plate, rig.support, probes, habits.contact));
    return Sitter(subject, seed, plan, rig, habits, std::move(plate));
  }

  /// Fills the volts of `trial`, if the plan has any; its number and rate must be set. Returns the trunk flexion.
  double perform(reach::Trial& trial, double target_cm, double pace_s) {
    const sim::CounterRandom random(seed_ + trial.number);
    sim::SittingHabits habits = habits_;
    if (pace_s > 0.0) {
      habits.phase_s = pace_s;
      habits.phase_growth_per_deg = 0.0;
    }
    habits.load.rest_y_mm += habits.rest_y_deviation_mm * random.gaussian_pair(0).first;
    sim::SeatedPerson person({.person = subject_.person,
                              .habits = habits,
                              .mode = sim::ReachMode::Never,
                              .has_fidgets = false,
                              .sit_down_s = kSatDownLongAgoS,
                              .seed = seed_ + trial.number});
    const double before_s = plan_.is_ideal ? kIdealRestBeforeS : 1.0 + random.uniform(4);
    const double after_s = plan_.is_ideal ? kIdealRestAfterS : 1.0 + 0.4 * random.uniform(5);
    sim::ReachRequest request{.number = trial.number, .start_s = before_s, .target_cm = target_cm};
    const double turn_deg = plan_.trunk_turn_deg.value_or(0.0);
    if (turn_deg > 0.0) request.trunk_deg = turn_deg - person.body().parameters().lean_back_deg;
    person.plan(request);
    const sim::ReachPlan reach = *person.at(0.0).reach;
    if (!plan_.has_volts) return reach.trunk_deg;
    const auto scans = static_cast<std::size_t>((reach.end_s + after_s) * trial.rate.hz());
    const sim::Daq daq({.bits = 16, .noise_v = plan_.noise_v, .seed = seed_ + trial.number});
    for (std::size_t scan = 0; scan < scans; ++scan) {
      auto& volts = trial.volts.emplace_back(volts_of(person.at(static_cast<double>(scan) / trial.rate.hz()).load));
      if (!plan_.is_ideal) daq.convert(volts, scan);
      for (double& volt : volts) volt += plan_.is_ideal && scan % 2 == 1 ? kLivingV : 0.0;
    }
    return reach.trunk_deg;
  }

 private:
  Sitter(const reach::Subject& subject, std::uint64_t seed, const TrialPlan& plan, const physics::RigModel& rig,
         const sim::SittingHabits& habits, sim::SeatPlate plate)
      : subject_(subject), seed_(seed), plan_(plan), rig_(rig), habits_(habits), plate_(std::move(plate)) {}

  [[nodiscard]] std::array<double, kTransientSensors> volts_of(const sim::SeatLoad& load) const {
    std::array<double, kTransientSensors> values{};
    plate_.deflect(load, values);
    for (std::size_t k = 0; k < kTransientSensors; ++k) {
      const physics::SensorModel& sensor = rig_.sensors[k];
      values[k] = sensor.curve.volts(sensor.unloaded_gap - core::Millimetres{values[k]}).value;
    }
    return values;
  }

  const reach::Subject& subject_;
  std::uint64_t seed_;
  const TrialPlan& plan_;
  const physics::RigModel& rig_;
  sim::SittingHabits habits_;
  sim::SeatPlate plate_;
};

double pace_of(const TrialPlan& plan, int trial) {
  return plan.paces_s.empty() ? 0.0 : plan.paces_s[static_cast<std::size_t>(trial) % plan.paces_s.size()];
}

}  // namespace

core::Result<SimulatedTrials> simulate_trials(const std::vector<reach::Subject>& subjects, const TrialPlan& plan,
                                              const std::function<void(double)>& progress) {
  DTS_TRY(check(subjects, plan));
  DTS_TRY_ASSIGN(const auto rate, core::Rate::from_hz(plan.rate_hz));
  SimulatedTrials simulated{.set = {.rig = transient_rig(), .subjects = subjects}};
  for (std::size_t index = 0; index < subjects.size(); ++index) {
    DTS_TRY_ASSIGN(auto sitter, Sitter::create(subjects[index], index, plan, simulated.set.rig));
    std::uint32_t number = 0;
    for (const std::string& condition : plan.conditions) {
      const double target_cm = *reach::target_cm(subjects[index].person, condition);
      if (target_cm > subjects[index].person.max_reach_cm) continue;
      for (int i = 0; i < plan.trials_per_condition; ++i) {
        reach::Trial trial{.subject = index, .number = ++number, .condition = condition, .rate = rate};
        simulated.trunk_deg.push_back(sitter.perform(trial, target_cm, pace_of(plan, i)));
        simulated.set.trials.push_back(std::move(trial));
      }
    }
    progress(static_cast<double>(index + 1) / static_cast<double>(subjects.size()));
  }
  return simulated;
}

}  // namespace dts::lab::reach
