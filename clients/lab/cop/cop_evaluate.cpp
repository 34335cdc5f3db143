// SPDX-License-Identifier: Apache-2.0
// `dtslab cop evaluate`: the errors of an estimator on the model of a rig's plate.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "cli/validators.h"
#include "files/cop_calibration_file.h"
#include "lab/base/command.h"
#include "lab/base/plot.h"
#include "lab/base/problems.h"
#include "lab/base/rig.h"
#include "lab/cop/cop_command.h"
#include "physics/cop/cop_evaluation.h"

namespace dts::lab::cop {
namespace {

struct EvaluateArguments {
  std::string rig;  ///< Rig file; empty: the thesis's floor platform.
  std::string estimator = "poly3";
  std::string noise = "none";
  std::string contact = "points";  ///< Or "one-foot", "two-feet".
  std::vector<double> loads_n;
  bool is_linear = false;  ///< Only thin-plate theory.
  bool is_json = false;
  std::string plot;  ///< Output file for a picture; empty: none.
};

using physics::CopErrorFigures;
using physics::CopEstimator;
using physics::CopEvaluation;
using physics::CopTrialError;
using physics::RigModel;
using physics::SensorRectangle;

constexpr std::size_t kGrid = 33;  ///< Positions per side, as in the study behind plate-model section 5.
constexpr std::size_t kStances = 400;
constexpr std::uint64_t kSeed = 4;
constexpr double kUsualLoadN = 490.0;  ///< Thesis 4.5.
constexpr double kLightPersonN = 300.0;
constexpr double kHeavyPersonN = 900.0;

struct EvaluationTask {
  RigModel rig;
  std::string estimator_name;
  physics::CopEvaluationOptions options;
  std::vector<double> loads_n;
  std::vector<physics::CopTrial> trials;
  bool is_grid = true;  ///< Point loads on a kGrid x kGrid grid over the sensor square, load by load.
};

/// Figures over a part of the trials.
struct Part {
  std::string name;
  CopErrorFigures figures;
};

core::Result<CopEstimator> make_estimator(const EvaluateArguments& arguments, const RigModel& rig, physics::PlateBehaviour behaviour) {
  DTS_TRY_ASSIGN(const auto method, physics::parse_cop_method(arguments.estimator));
  return CopEstimator::from_model(method, rig, behaviour);
}

core::Result<EvaluationTask> make_task(const EvaluateArguments& arguments, RigModel rig) {
  EvaluationTask task{.rig = std::move(rig), .estimator_name = arguments.estimator, .loads_n = arguments.loads_n};
  DTS_TRY_ASSIGN(const auto noise, physics::parse_cop_noise(arguments.noise));
  task.options = {.behaviour = arguments.is_linear ? physics::PlateBehaviour::Linear : physics::PlateBehaviour::Stiffening,
                  .noise = noise,
                  .seed = kSeed};
  task.is_grid = arguments.contact == "points";
  if (task.loads_n.empty()) task.loads_n = task.is_grid ? std::vector{kUsualLoadN} : std::vector{kLightPersonN, kHeavyPersonN};
  if (task.is_grid) {
    task.trials = physics::point_trials(physics::grid_positions(SensorRectangle::of(task.rig), kGrid), task.loads_n);
  } else {
    const auto [lightest, heaviest] = std::ranges::minmax(task.loads_n);
    const physics::Interval load_n{lightest, heaviest};
    task.trials = physics::foot_trials(task.rig.plate, arguments.contact == "one-foot" ? 1 : 2, kStances, load_n, kSeed);
  }
  if (!task.trials.empty()) return task;
  return core::fail(core::ErrorCode::InvalidArgument, "this plate is too small for a foot", "use --contact points");
}

CopErrorFigures figures_where(const CopEvaluation& evaluation, const std::function<bool(const CopTrialError&)>& counts) {
  std::vector<physics::CopCalibrationPoint> points;
  for (const CopTrialError& trial : evaluation.trials) {
    if ((trial.estimate.flags & physics::cop_flag::kNoContact) == 0 && counts(trial)) points.push_back(trial.point);
  }
  return physics::error_figures(points);
}

std::string load_name(double load_n) { return cli::decimal(load_n, 0) + " N"; }

/// Returns the figures over all trials, and for point loads those of each load over the sensor square and its central 200 mm.
std::vector<Part> parts_of(const EvaluationTask& task, const CopEvaluation& evaluation) {
  std::vector<Part> parts;
  if (!task.is_grid || task.loads_n.size() > 1) parts.push_back({"all", evaluation.figures});
  if (!task.is_grid) return parts;
  const physics::Point centre = SensorRectangle::of(task.rig).centre();
  for (const double load_n : task.loads_n) {
    const auto has_load = [&](const CopTrialError& trial) { return trial.point.sample.load.value == load_n; };
    const auto is_central = [&](const CopTrialError& trial) {
      const auto& [x, y] = trial.point.sample.load_position;
      return has_load(trial) && std::abs(x.value - centre.x.value) <= 100.0 && std::abs(y.value - centre.y.value) <= 100.0;
    };
    parts.push_back({load_name(load_n) + ", sensor square", figures_where(evaluation, has_load)});
    parts.push_back({load_name(load_n) + ", central 200 mm", figures_where(evaluation, is_central)});
  }
  return parts;
}

double error_mm(const CopTrialError& trial) { return std::hypot(trial.point.x_error_mm, trial.point.y_error_mm); }

void set_figures(cli::Json& json, const CopErrorFigures& figures) {
  cli::set_number(json, "rms_x_mm", figures.rms_x_mm);
  cli::set_number(json, "rms_y_mm", figures.rms_y_mm);
  cli::set_number(json, "rms_total_mm", figures.rms_total_mm);
  cli::set_number(json, "max_total_mm", figures.max_total_mm);
  cli::set_number(json, "load_rms_percent", figures.load_rms_percent);
}

cli::Json to_json(const EvaluateArguments& arguments, const EvaluationTask& task, const CopEvaluation& evaluation) {
  cli::Json json{{"estimator", task.estimator_name},
                 {"noise", arguments.noise},
                 {"plate", arguments.is_linear ? "linear" : "stiffening"},
                 {"contact", arguments.contact}};
  json["loads_n"] = task.loads_n;
  set_figures(json, evaluation.figures);
  json["no_contact"] = evaluation.no_contact_count;
  json["outside_calibration"] = evaluation.outside_count;
  json["parts"] = cli::Json::array();
  for (const Part& part : parts_of(task, evaluation)) {
    cli::Json figures{{"name", part.name}};
    set_figures(figures, part.figures);
    json["parts"].push_back(std::move(figures));
  }
  json["map"] = cli::Json::array();
  for (const CopTrialError& trial : evaluation.trials) {
    const physics::CopSample& sample = trial.point.sample;
    cli::Json place{{"x_mm", sample.load_position.x.value}, {"y_mm", sample.load_position.y.value}, {"p_n", sample.load.value}};
    cli::set_number(place, "dx_mm", trial.point.x_error_mm);
    cli::set_number(place, "dy_mm", trial.point.y_error_mm);
    cli::set_number(place, "dp_percent", trial.point.load_error_percent);
    place["flags"] = physics::cop_flags_text(trial.estimate.flags);
    json["map"].push_back(std::move(place));
  }
  return json;
}

/// Prints the error in mm at every fourth position of the grid, for the first load, as seen from above.
void print_map(const EvaluationTask& task, const CopEvaluation& evaluation, cli::Console& console) {
  constexpr std::size_t kStep = 4;
  std::vector<std::string> headers{">y (mm) \\ x (mm)"};
  for (std::size_t i = 0; i < kGrid; i += kStep) {
    headers.push_back(">" + cli::decimal(task.trials[i].centre.x.value, 0));
  }
  cli::Table map(headers);
  for (std::size_t row = 0; row < kGrid; row += kStep) {
    const std::size_t first = (kGrid - 1 - row) * kGrid;
    std::vector<cli::Cell> cells{{cli::decimal(task.trials[first].centre.y.value, 0)}};
    for (std::size_t i = 0; i < kGrid; i += kStep) cells.push_back({cli::decimal(error_mm(evaluation.trials[first + i]), 2)});
    map.add(std::move(cells));
  }
  console.out << "\nError (mm) under " << load_name(task.loads_n.front()) << ":\n";
  map.print(console);
}

void print(const EvaluationTask& task, const CopEvaluation& evaluation, cli::Console& console) {
  cli::Table table({"PART", ">RMS X (mm)", ">RMS Y (mm)", ">RMS TOTAL (mm)", ">LARGEST (mm)", ">LOAD RMS (%)"});
  for (const auto& [name, figures] : parts_of(task, evaluation)) {
    table.add({{name},
               {cli::decimal(figures.rms_x_mm, 3)},
               {cli::decimal(figures.rms_y_mm, 3)},
               {cli::decimal(figures.rms_total_mm, 3)},
               {cli::decimal(figures.max_total_mm, 3)},
               {cli::decimal(figures.load_rms_percent, 3)}});
  }
  table.print(console);
  console.out << '\n' << evaluation.trials.size() << " loads";
  if (evaluation.outside_count > 0) console.out << ", " << evaluation.outside_count << " flagged as outside the calibration";
  if (evaluation.no_contact_count > 0) console.out << ", " << evaluation.no_contact_count << " without contact";
  console.out << '\n';
  if (task.is_grid) print_map(task, evaluation, console);
}

core::Status plot(const EvaluationTask& task, const CopEvaluation& evaluation, const std::string& file) {
  if (!task.is_grid) return core::fail(core::ErrorCode::InvalidArgument, "an error map needs point loads", "use --contact points");
  const auto area = SensorRectangle::of(task.rig);
  Marks sensors{.name = "sensor", .symbol = 7, .points = {}};
  for (const physics::SensorModel& sensor : task.rig.sensors) sensors.points.push_back(sensor.position);
  const auto at_grid = [&](physics::Point at) {
    const auto index = [](core::Millimetres value, core::Millimetres from, core::Millimetres to) {
      return static_cast<std::size_t>(std::lround((value - from) / (to - from) * static_cast<double>(kGrid - 1)));
    };
    return error_mm(evaluation.trials[index(at.y, area.bottom, area.top) * kGrid + index(at.x, area.left, area.right)]);
  };
  return draw_map({.title = "Error of " + task.estimator_name + " under " + load_name(task.loads_n.front()),
                   .quantity = "error (mm)",
                   .from = {area.left, area.bottom},
                   .to = {area.right, area.top},
                   .cells = static_cast<int>(kGrid) - 1,
                   .value = at_grid,
                   .marks = {support_marks(task.rig.plate, task.rig.support), sensors},
                   .plate = task.rig.plate},
                  file);
}

int run_cop_evaluate(const EvaluateArguments& arguments, cli::Console& console) {
  if (!arguments.plot.empty()) {
    if (const auto status = check_plot_name(arguments.plot); !status) return fail_with(console, status.error());
  }
  files::Problems problems;
  RigModel rig = read_rig(arguments.rig, problems);
  if (!problems.empty()) return report_problems(console, problems);
  const auto task = make_task(arguments, std::move(rig));
  if (!task) return fail_with(console, task.error());
  const auto estimator = make_estimator(arguments, task->rig, task->options.behaviour);
  if (!estimator) return fail_with(console, estimator.error());
  const auto evaluation = physics::evaluate_cop(task->rig, *estimator, task->trials, task->options);
  if (!evaluation) return fail_with(console, evaluation.error());
  if (!arguments.plot.empty()) {
    if (const auto plotted = plot(*task, *evaluation, arguments.plot); !plotted) return fail_with(console, plotted.error());
  }
  if (arguments.is_json) {
    console.out << cli::document(to_json(arguments, *task, *evaluation));
  } else {
    print(*task, *evaluation, console);
  }
  return cli::kOk;
}

}  // namespace

void add_evaluate(cli::CommandLine& line, CLI::App& cop) {
  const auto [command, arguments] =
      add_command(line, cop, "evaluate", "Map the error of a centre-of-pressure estimator over the model of a rig's plate",
                  "dtslab cop evaluate | platform of the thesis, poly3, without noise\n"
                  "dtslab cop evaluate --estimator thesis --noise realistic --plot map.svg | one noisy scan per position, and a map\n"
                  "dtslab cop evaluate --loads 240 490 700 --json | with several loads\n"
                  "dtslab cop evaluate --rig rig.toml --contact two-feet | with random stances\n",
                  run_cop_evaluate);
  add_rig(command, arguments.rig, "Rig file; default: the thesis's floor platform");
  add_estimator(command, arguments.estimator, {"poly3", "thesis", "thesis_per_pair", "moment", "model"});
  command.add_option("--noise", arguments.noise, "none, or realistic: noise of one filtered scan of a real sensor. Default: none")
      ->option_text("NOISE")
      ->check(CLI::IsMember({"none", "realistic"}));
  command
      .add_option("--loads", arguments.loads_n,
                  "Loads in N; for feet: weight of the lightest and the heaviest person. Default: 490; for feet 300 900")
      ->option_text("N ...")
      ->check(cli::number_between(1.0, 2000.0, "newtons"));
  command.add_option("--contact", arguments.contact, "points, one-foot or two-feet (random stances); default: points")
      ->option_text("CONTACT")
      ->check(CLI::IsMember({"points", "one-foot", "two-feet"}));
  add_linear(command, arguments.is_linear);
  add_json(command, arguments.is_json);
  add_plot(command, arguments.plot, "Draw the error under the first load");
}

}  // namespace dts::lab::cop
