// SPDX-License-Identifier: Apache-2.0
#include "lab/thesis/stack_trials.h"

#include <cmath>
#include <sstream>

#include "cli/table.h"
#include "lab/base/thesis_setup.h"
#include "lab/simulate/simulated_cop.h"
#include "lab/simulate/simulated_rig.h"

namespace dts::lab::thesis {
namespace {

using simulate::SimulatedCop;

constexpr double kStackRateHz = 100.0;
constexpr std::size_t kScansIn50Ms = 5;
constexpr double kStepOnS = 2.5;
constexpr double kTrialS = 25.0;
constexpr double kDiscardedS = 5.0;
constexpr double kPlatformHeightMm = 50.0;  // not in the thesis

/// The thesis says "various weights" and "the middle area"; masses and places are ours.
struct Volunteer {
  const char* name;
  double mass_kg;
  double x_mm;
  double y_mm;
};
constexpr std::array<Volunteer, kStackVolunteers> kVolunteers{
    {{"V1", 55.0, -8.0, 4.0}, {"V2", 64.0, 6.0, -10.0}, {"V3", 72.0, 3.0, 8.0}, {"V4", 83.0, -12.0, -5.0}, {"V5", 95.0, 10.0, 12.0}}};

/// Returns the part of the address that both devices share: the person.
std::string person_options(const Volunteer& volunteer, std::size_t number, bool is_one_foot) {
  const double weight_n = volunteer.mass_kg * thesis_setup::kNewtonsPerKgf;
  return "seed=" + std::to_string(number + 1) + "&weight_n=" + cli::decimal(weight_n, 1) + "&x_mm=" + cli::decimal(volunteer.x_mm, 0) +
         "&y_mm=" + cli::decimal(volunteer.y_mm, 0) + "&step_on_s=" + cli::decimal(kStepOnS, 1) +
         (is_one_foot ? "&contact=one_foot" : "&contact=feet");
}

std::vector<double> trial_part(const std::vector<double>& whole) {
  const auto first = static_cast<std::ptrdiff_t>((kStepOnS + kDiscardedS) * kStackRateHz);
  const auto last = static_cast<std::ptrdiff_t>((kStepOnS + kTrialS) * kStackRateHz);
  return {whole.begin() + first, whole.begin() + last};
}

core::Result<StackTrial> simulate_trial(std::size_t number, bool is_one_foot) {
  const std::string person = person_options(kVolunteers.at(number), number, is_one_foot);
  // 12 bits of +-10 V have the codes of the thesis's 11 bits of +-5 V.
  DTS_TRY_ASSIGN(const SimulatedCop floor, simulate::simulate_cop(simulate::floor_definition(kStackRateHz), "the floor platform",
                                                                  "sim:stack?part=floor&noise_mv=3&bits=12&" + person, kStepOnS + kTrialS));
  DTS_TRY_ASSIGN(
      const SimulatedCop plate,
      simulate::simulate_cop(simulate::force_plate_definition(kStackRateHz, kPlatformHeightMm), "the force plate",
                             "sim:stack?part=plate&height_mm=" + cli::decimal(kPlatformHeightMm, 0) + "&" + person, kStepOnS + kTrialS));
  return StackTrial{.ml = {trial_part(floor.ml_mm), trial_part(plate.ml_mm)}, .ap = {trial_part(floor.ap_mm), trial_part(plate.ap_mm)}};
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Both devices about their own mean, as the figures need it: the printed ones overlap.
void write_trial(std::ostream& script, const std::string& name, const StackTrial& trial) {
  script << '$' << name << " << END\n";
  const std::array<double, 4> centres{mean(trial.ml.floor_mm), mean(trial.ml.plate_mm), mean(trial.ap.floor_mm), mean(trial.ap.plate_mm)};
  for (std::size_t i = 0; i < trial.ml.floor_mm.size(); ++i) {
    script << kDiscardedS + static_cast<double>(i) / kStackRateHz << ' ' << trial.ml.floor_mm[i] - centres[0] << ' '
           << trial.ml.plate_mm[i] - centres[1] << ' ' << trial.ap.floor_mm[i] - centres[2] << ' ' << trial.ap.plate_mm[i] - centres[3]
           << '\n';
  }
  script << "END\n";
}

void plot_series(std::ostream& script, const std::string& name, const std::string& title) {
  script << "set size noratio\nset xlabel 'time (s)'\n";
  for (const auto& [axis, columns] : {std::pair("x (ML)", std::pair(3, 2)), {"y (AP)", {5, 4}}}) {
    script << "set title '" << title << ", COP " << axis << "'\nset ylabel 'mm'\nplot $" << name << " using 1:" << columns.first
           << " with lines lw 2 lc rgb '#3b528b', $" << name << " using 1:" << columns.second << " with lines lc rgb '#d1495b'\n";
  }
}

void plot_stabilogram(std::ostream& script, const std::string& name, const std::string& title) {
  script << "set size ratio -1\nset title '" << title << "'\nset xlabel 'x (ML), mm'\nset ylabel 'y (AP), mm'\nplot $" << name
         << " using 3:5 with lines lw 2 lc rgb '#3b528b', $" << name << " using 2:4 with lines lc rgb '#d1495b'\n";
}

}  // namespace

AxisComparison compare(const StackTrial::Axis& axis) {
  const auto count = static_cast<double>(axis.floor_mm.size());
  double sum = 0.0;
  double squares = 0.0;
  double moved = 0.0;
  for (std::size_t i = 0; i < axis.floor_mm.size(); ++i) {
    const double difference = axis.floor_mm[i] - axis.plate_mm[i];
    sum += difference;
    squares += difference * difference;
    if (i < kScansIn50Ms) continue;
    const double step_mm = axis.plate_mm[i] - axis.plate_mm[i - kScansIn50Ms];
    moved += step_mm * step_mm;
  }
  return {.raw_mm = std::sqrt(squares / count),
          .mean_removed_mm = std::sqrt(squares / count - (sum / count) * (sum / count)),
          .moved_in_50_ms_mm = std::sqrt(moved / (count - static_cast<double>(kScansIn50Ms)))};
}

core::Result<StackTrials> simulate_stack_trials(const TableProgress& progress) {
  StackTrials trials;
  for (std::size_t number = 0; number < kStackVolunteers; ++number) {
    DTS_TRY_ASSIGN(trials.two_feet.at(number), simulate_trial(number, false));
    progress((static_cast<double>(number) + 0.5) / static_cast<double>(kStackVolunteers));
    DTS_TRY_ASSIGN(trials.one_foot.at(number), simulate_trial(number, true));
    progress(static_cast<double>(number + 1) / static_cast<double>(kStackVolunteers));
  }
  return trials;
}

std::string stack_volunteers_text() {
  std::string text;
  for (const Volunteer& volunteer : kVolunteers) {
    text += (text.empty() ? "" : ", ") + std::string(volunteer.name) + " " + cli::decimal(volunteer.mass_kg, 0) + " kg";
  }
  return text;
}

std::string stack_figures(const StackTrials& trials) {
  std::ostringstream script;
  script.precision(9);
  write_trial(script, "v3_two", trials.two_feet[2]);
  write_trial(script, "v4_two", trials.two_feet[3]);
  write_trial(script, "v3_one", trials.one_foot[2]);
  write_trial(script, "v4_one", trials.one_foot[3]);
  write_trial(script, "v5_one", trials.one_foot[4]);
  script << "set tics out nomirror\nset xtics 5\nset ytics 5\nunset key\n"
         << "set multiplot layout 4,2 title 'Figures 4.11 to 4.13, simulated people: synthetic. Blue: force plate, red: floor platform, "
            "each about its mean'\n";
  plot_series(script, "v3_two", "4.11: V3, two feet");
  plot_series(script, "v4_one", "4.12: V4, one foot");
  plot_stabilogram(script, "v4_two", "4.13: V4, two feet");
  plot_stabilogram(script, "v3_one", "4.13: V3, one foot");
  plot_stabilogram(script, "v4_one", "4.13: V4, one foot");
  plot_stabilogram(script, "v5_one", "4.13: V5, one foot");
  script << "unset multiplot\n";
  return script.str();
}

}  // namespace dts::lab::thesis
