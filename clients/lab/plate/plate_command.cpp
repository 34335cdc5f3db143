// SPDX-License-Identifier: Apache-2.0
#include "lab/plate/plate_command.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "cli/validators.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/plate/plate_case.h"
#include "lab/plate/plate_plot.h"
#include "physics/plate/grid.h"

namespace dts::lab::plate {
namespace {

struct SolveArguments {
  std::string case_file;
  std::optional<std::string> method;
  std::optional<int> divisions;
  bool is_nonlinear = false;
  bool is_json = false;
  std::string plot;  ///< Output file for a picture; empty: none.
};

using cli::decimal;
using physics::PlateCase;
using physics::PlateMethod;
using physics::PlateSolution;

/// A case with all defaults resolved.
struct PlateTask {
  PlateCase plate_case;
  PlateMethod method;
  physics::SolveOptions options;

  [[nodiscard]] std::string method_name() const { return method == PlateMethod::Fem ? "fem" : "fdm"; }
};

struct Solved {
  PlateSolution solution;
  double solve_ms;
};

/// The command line has priority over the file.
PlateTask make_task(PlateCaseFile file, const SolveArguments& arguments) {
  PlateTask task{.plate_case = std::move(file.plate_case), .method = file.method};
  if (arguments.method) task.method = *arguments.method == "fem" ? PlateMethod::Fem : PlateMethod::Fdm;
  task.options.is_nonlinear = file.is_nonlinear || arguments.is_nonlinear;
  task.options.spreads_point_loads = file.spreads_point_loads;
  const int usual = physics::default_divisions(task.method, task.options.is_nonlinear);
  task.options.divisions = arguments.divisions.value_or(file.divisions.value_or(usual));
  return task;
}

core::Result<Solved> solve(PlateTask& task, cli::Console& console) {
  cli::Progress progress(console, "solving");
  progress.tick_by_itself();  // factorising is one step without progress
  task.options.report_progress = [&](double fraction) { progress.report(fraction); };
  const auto begun = std::chrono::steady_clock::now();
  DTS_TRY_ASSIGN(auto solution, physics::solve(task.plate_case, task.method, task.options));
  const std::chrono::duration<double, std::milli> passed = std::chrono::steady_clock::now() - begun;
  return Solved{std::move(solution), passed.count()};
}

double total_load_n(const PlateCase& plate_case) {
  return std::accumulate(plate_case.loads.begin(), plate_case.loads.end(), 0.0,
                         [](double sum, const physics::PlateLoad& load) { return sum + load.force.value; });
}

cli::Json to_json(const PlateTask& task, const Solved& solved) {
  cli::Json json{{"method", task.method_name()}, {"divisions", task.options.divisions}, {"nonlinear", task.options.is_nonlinear}};
  json["probes"] = cli::Json::array();
  for (std::size_t k = 0; k < task.plate_case.probes.size(); ++k) {
    const physics::Point& at = task.plate_case.probes[k];
    cli::Json probe{{"x_mm", at.x.value}, {"y_mm", at.y.value}};
    cli::set_number(probe, "deflection_mm", solved.solution.probes[k].deflection_mm);
    cli::set_number(probe, "error_estimate_mm", solved.solution.probes[k].error_estimate_mm);
    json["probes"].push_back(std::move(probe));
  }
  json["reactions_n"] = solved.solution.reactions_n;
  json["load_n"] = total_load_n(task.plate_case);
  if (task.options.is_nonlinear) {
    json["load_steps"] = solved.solution.load_steps;
    json["newton_iterations"] = solved.solution.newton_iterations;
  }
  json["solve_ms"] = solved.solve_ms;
  return json;
}

/// Returns the name of the support for each element of PlateSolution::reactions_n.
std::vector<std::string> support_names(physics::SupportKind kind) {
  switch (kind) {
    case physics::SupportKind::Corner: return {"left back", "right back", "left front", "right front"};
    case physics::SupportKind::XEdges: return {"edge x = 0", "edge x = a"};
    case physics::SupportKind::Edges:
    case physics::SupportKind::Clamped: return {"edge x = 0", "edge x = a", "edge y = 0", "edge y = b"};
  }
  return {};
}

/// Returns the largest deflection of the whole plate: at grid points, loads and probes.
double largest_deflection_mm(const PlateTask& task, const PlateSolution& solution) {
  constexpr int kPlaces = 40;  // along each side
  double largest_mm = 0.0;
  const auto look = [&](const physics::Point& at) { largest_mm = std::max(largest_mm, std::abs(solution.deflection_mm(at))); };
  const physics::Plate& plate = task.plate_case.plate;
  for (int j = 0; j <= kPlaces; ++j) {
    for (int i = 0; i <= kPlaces; ++i) look({plate.a * (static_cast<double>(i) / kPlaces), plate.b * (static_cast<double>(j) / kPlaces)});
  }
  for (const physics::PlateLoad& load : task.plate_case.loads) look(load.area.centre);
  for (const physics::Point& probe : task.plate_case.probes) look(probe);
  return largest_mm;
}

/// Plate-model section 6: the linear plate is accurate while it bends by less than half its thickness. Every plate theory assumes small
/// slopes: a deflection of a tenth of the side is a slope of a fifth and more.
void warn_of_large_deflection(const PlateTask& task, const Solved& solved, cli::Console& console) {
  const physics::Plate& plate = task.plate_case.plate;
  const double largest_mm = largest_deflection_mm(task, solved.solution);
  const double side_mm = std::min(plate.a.value, plate.b.value);
  const std::string bends = "the plate bends by " + decimal(largest_mm, 2) + " mm, more than ";
  if (largest_mm > 0.1 * side_mm) {
    warn(console, bends + "a tenth of its shorter side (" + decimal(side_mm, 1) + " mm): plate theory is not valid here");
  } else if (!task.options.is_nonlinear && largest_mm > 0.5 * plate.h.value) {
    warn(console, bends + "half its thickness (" + decimal(plate.h.value, 2) +
                      " mm): linear theory is not valid here, because real plates stiffen by stretching; use --nonlinear");
  }
}

/// A point support of the model also holds the plate down; a real support only carries it.
void warn_of_lifting(const PlateTask& task, const Solved& solved, cli::Console& console) {
  if (task.plate_case.support.kind != physics::SupportKind::Corner) return;
  double scale_n = 0.0;
  for (const physics::PlateLoad& load : task.plate_case.loads) scale_n += std::abs(load.force.value);
  const auto names = support_names(task.plate_case.support.kind);
  for (std::size_t k = 0; k < std::min(names.size(), solved.solution.reactions_n.size()); ++k) {
    const double reaction_n = solved.solution.reactions_n[k];
    if (reaction_n >= -1e-6 * scale_n) continue;
    warn(console, "support " + names[k] + ": " + decimal(reaction_n, 3) +
                      " N (upward); unless the plate is held down there, it lifts off this support and bends differently");
  }
}

void print(const PlateTask& task, const Solved& solved, cli::Console& console) {
  cli::Table probes({">PROBE", ">X (mm)", ">Y (mm)", ">DEFLECTION (mm)", ">ERROR ESTIMATE (mm)"});
  for (std::size_t k = 0; k < task.plate_case.probes.size(); ++k) {
    const physics::Point& at = task.plate_case.probes[k];
    const physics::ProbeResult& result = solved.solution.probes[k];
    probes.add({{std::to_string(k + 1)},
                {decimal(at.x.value, 2)},
                {decimal(at.y.value, 2)},
                {decimal(result.deflection_mm, 4)},
                {decimal(result.error_estimate_mm, 4)}});
  }
  probes.print(console);
  if (!task.plate_case.probes.empty()) console.out << '\n';
  cli::Table supports({"SUPPORT", ">REACTION (N)"});
  const auto names = support_names(task.plate_case.support.kind);
  for (std::size_t k = 0; k < solved.solution.reactions_n.size(); ++k) {
    supports.add({{k < names.size() ? names[k] : std::to_string(k + 1)}, {decimal(solved.solution.reactions_n[k], 3)}});
  }
  const auto& reactions = solved.solution.reactions_n;
  supports.add({{"sum", cli::Style::Bold}, {decimal(std::accumulate(reactions.begin(), reactions.end(), 0.0), 3), cli::Style::Bold}});
  supports.print(console);
  console.out << "\nload " << decimal(total_load_n(task.plate_case), 3) << " N; " << task.method_name() << ", " << task.options.divisions
              << " divisions" << (task.options.is_nonlinear ? ", non-linear" : "") << ", " << decimal(solved.solve_ms, 1) << " ms\n";
}

int run_plate_solve(const SolveArguments& arguments, cli::Console& console) {
  if (!arguments.plot.empty()) {
    if (const auto status = check_plot_name(arguments.plot); !status) return fail_with(console, status.error());
  }
  files::Problems problems;
  PlateCaseFile file = read_plate_case(arguments.case_file, problems);
  if (!problems.empty()) return report_problems(console, problems);
  PlateTask task = make_task(std::move(file), arguments);
  const auto solved = solve(task, console);
  if (!solved) return fail_with(console, solved.error());
  if (!arguments.plot.empty()) {
    const auto plotted = plot_plate(task.plate_case, solved->solution, arguments.plot);
    if (!plotted) return fail_with(console, plotted.error());
  }
  if (arguments.is_json) {
    console.out << cli::document(to_json(task, *solved));
  } else {
    print(task, *solved, console);
  }
  warn_of_large_deflection(task, *solved, console);
  warn_of_lifting(task, *solved, console);
  return cli::kOk;
}

}  // namespace

void add_commands(cli::CommandLine& line) {
  CLI::App* plate = cli::add_group(line.app, "plate", "Compute the bending of elastic plates",
                                   "dtslab plate solve case.toml | deflections and reactions\n");
  const auto [command, arguments] =
      add_command(line, *plate, "solve", "Compute a plate under loads: deflections at the probes and reactions of the supports",
                  "dtslab plate solve case.toml | a table\n"
                  "dtslab plate solve case.toml --method fem --divisions 80 | with finite elements\n"
                  "dtslab plate solve case.toml --nonlinear --json | with membrane stiffening, for a program\n"
                  "dtslab plate solve case.toml --plot plate.svg | also draw the deflection\n",
                  run_plate_solve);
  command.add_option("CASE.toml", arguments.case_file, "Plate, support, loads and probes; see dtslab man")->required()->option_text(" ");
  command.add_option("--method", arguments.method, "fdm (finite differences) or fem (finite elements). Default: as in the file, else fdm")
      ->option_text("METHOD")
      ->check(CLI::IsMember({"fdm", "fem"}));
  command
      .add_option("--divisions", arguments.divisions,
                  "Divisions of each side, 4 to 200 (non-linear: up to " + std::to_string(physics::kMostNonlinearDivisions) + ")")
      ->option_text("N")
      ->check(cli::whole_number_between(physics::Grid::kMinDivisions, physics::Grid::kMaxDivisions));
  command.add_flag("--nonlinear", arguments.is_nonlinear, "Include stiffening by stretching (von Karman)");
  add_json(command, arguments.is_json);
  add_plot(command, arguments.plot, "Draw the deflection");
}

}  // namespace dts::lab::plate
