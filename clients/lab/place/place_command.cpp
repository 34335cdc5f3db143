// SPDX-License-Identifier: Apache-2.0
#include "lab/place/place_command.h"

#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "lab/base/command.h"
#include "lab/base/plot.h"
#include "lab/base/problems.h"
#include "lab/base/rig.h"
#include "lab/place/placement.h"

namespace dts::lab::place {
namespace {

struct Arguments {
  std::string rig;  ///< Rig file; empty: the thesis's floor platform.
  std::size_t sensor_count = 4;
  bool is_linear = false;  ///< Only thin-plate theory.
  bool is_json = false;
  std::string plot;  ///< Output file for a picture; empty: none.
};

using cli::decimal;

/// Returns the distance and the sensor positions at that distance.
cli::Json choice_json(const physics::RigModel& rig, const Arguments& arguments, const PlacementFigures& row) {
  cli::Json json{{"distance_mm", row.distance_mm}, {"sensors", cli::Json::array()}};
  for (const physics::Point& point : sensor_layout(rig.plate, arguments.sensor_count, row.distance_mm)) {
    json["sensors"].push_back({{"x_mm", point.x.value}, {"y_mm", point.y.value}});
  }
  return json;
}

cli::Json to_json(const physics::RigModel& rig, const Arguments& arguments, const Placement& placement) {
  cli::Json json{
      {"sensor_count", arguments.sensor_count}, {"plate", arguments.is_linear ? "linear" : "stiffening"}, {"rows", cli::Json::array()}};
  for (const PlacementFigures& row : placement.rows) {
    cli::Json figures{{"distance_mm", row.distance_mm}};
    cli::set_number(figures, "noise_limit_mm", row.noise_limit_mm);
    cli::set_number(figures, "one_foot_mm", row.one_foot_mm);
    cli::set_number(figures, "two_feet_mm", row.two_feet_mm);
    cli::set_number(figures, "standing_mm", row.standing_mm);
    json["rows"].push_back(std::move(figures));
  }
  json["recommended"] = {{"standing", choice_json(rig, arguments, placement.rows[placement.best_standing])},
                         {"point_loads", choice_json(rig, arguments, placement.rows[placement.best_point_load])}};
  return json;
}

void print(const Placement& placement, cli::Console& console) {
  cli::Table table({">FROM THE EDGES (mm)", ">NOISE LIMIT (mm)", ">ONE FOOT (mm)", ">TWO FEET (mm)", ">STANDING (mm)", ""});
  for (std::size_t k = 0; k < placement.rows.size(); ++k) {
    const PlacementFigures& row = placement.rows[k];
    std::string note = k == placement.best_standing ? "best for people" : "";
    if (k == placement.best_point_load) note += std::string(note.empty() ? "" : ", ") + "best for point loads";
    const cli::Style style = note.empty() ? cli::Style::Plain : cli::Style::Good;
    table.add({{decimal(row.distance_mm, 0), style},
               {decimal(row.noise_limit_mm, 2), style},
               {decimal(row.one_foot_mm, 2), style},
               {decimal(row.two_feet_mm, 2), style},
               {decimal(row.standing_mm, 2), style},
               {note, style}});
  }
  table.print(console);
  console.out << "\nNoise limit: Cramer-Rao, point load of 490 N, one filtered scan. One foot, two feet: error of a calibrated estimator\n"
                 "without noise under random stances of 300 to 900 N. Standing: both together. All rms.\n";
}

core::Status plot(const Placement& placement, const std::string& file) {
  const auto curve = [&](const char* curve_name, double PlacementFigures::*figure) {
    Curve result{.name = curve_name, .points = {}};
    for (const PlacementFigures& row : placement.rows) result.points.emplace_back(row.distance_mm, row.*figure);
    return result;
  };
  return draw_curves({.title = "Accuracy over the place of the sensors",
                      .x_label = "distance from the edges (mm)",
                      .y_label = "rms error (mm)",
                      .curves = {curve("noise limit", &PlacementFigures::noise_limit_mm), curve("one foot", &PlacementFigures::one_foot_mm),
                                 curve("two feet", &PlacementFigures::two_feet_mm), curve("standing", &PlacementFigures::standing_mm)}},
                     file);
}

int run_place(const Arguments& arguments, cli::Console& console) {
  if (!arguments.plot.empty()) {
    if (const auto status = check_plot_name(arguments.plot); !status) return fail_with(console, status.error());
  }
  files::Problems problems;
  const physics::RigModel rig = read_rig(arguments.rig, problems);
  if (!problems.empty()) return report_problems(console, problems);
  const auto behaviour = arguments.is_linear ? physics::PlateBehaviour::Linear : physics::PlateBehaviour::Stiffening;
  core::Result<Placement> placement;
  {
    cli::Progress progress(console, "placing");
    placement = place_sensors(rig, arguments.sensor_count, behaviour, [&](double fraction) { progress.report(fraction); });
  }
  if (!placement) return fail_with(console, placement.error());
  if (!arguments.plot.empty()) {
    if (const auto plotted = plot(*placement, arguments.plot); !plotted) return fail_with(console, plotted.error());
  }
  if (arguments.is_json) {
    console.out << cli::document(to_json(rig, arguments, *placement));
  } else {
    print(*placement, console);
  }
  return cli::kOk;
}

}  // namespace

void add_commands(cli::CommandLine& line) {
  const auto [command, arguments] = add_command(line, line.app, "place", "Find the best sensor positions under a rig's plate",
                                                "dtslab place | four sensors under the platform of the thesis\n"
                                                "dtslab place --rig rig.toml --sensors 16 --json | sixteen sensors under another plate\n"
                                                "dtslab place --plot place.svg | draw the accuracy over the distance from the edges\n",
                                                run_place);
  add_rig(command, arguments.rig, "Rig file; default: the thesis's floor platform");
  command.add_option("--sensors", arguments.sensor_count, "Number of sensors: 4, 8 or 16. Default: 4")->option_text("N")->check(CLI::IsMember({4, 8, 16}));
  add_linear(command, arguments.is_linear);
  add_json(command, arguments.is_json);
  add_plot(command, arguments.plot, "Draw the results");
}

}  // namespace dts::lab::place
