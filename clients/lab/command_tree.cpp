// SPDX-License-Identifier: Apache-2.0
#include "lab/command_tree.h"

#include <string>

#include "cli/validators.h"
#include "core/join.h"
#include "lab/compare_command.h"
#include "lab/cop_command.h"
#include "lab/manual.h"
#include "lab/place_command.h"
#include "lab/plate_command.h"
#include "lab/reach_tree.h"
#include "lab/replay_command.h"
#include "lab/simulate_command.h"
#include "lab/sway/sway_tree.h"
#include "lab/thesis_command.h"
#include "physics/plate/grid.h"
#include "physics/plate/solve.h"

namespace dts::lab {
namespace {

void add_plot(CLI::App& command, Arguments& arguments, const std::string& what) {
  command.add_option("--plot", arguments.plot, what + "; .svg or .png (needs gnuplot)")->option_text("FILE");
}

void add_linear(CLI::App& command, Arguments& arguments) {
  command.add_flag("--linear", arguments.is_linear, "Thin-plate theory alone, without stiffening by stretching");
}

void add_plate(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* plate =
      cli::add_group(tree.line.app, "plate", "Bend elastic plates", "dtslab plate solve case.toml | deflections and reactions\n");
  CLI::App* solve = add_command(tree, *plate, "solve", "Solve a plate under loads: deflections at the probes, reactions of the supports",
                                "dtslab plate solve case.toml | a table\n"
                                "dtslab plate solve case.toml --method fem --divisions 80 | by finite elements\n"
                                "dtslab plate solve case.toml --nonlinear --json | with membrane stiffening, for a program\n"
                                "dtslab plate solve case.toml --plot plate.svg | and a picture of the bent plate\n",
                                run_plate_solve);
  solve->add_option("CASE.toml", arguments.case_file, "Plate, support, loads and probes; see dtslab man")->required()->option_text(" ");
  solve->add_option("--method", arguments.method, "fdm (finite differences) or fem (finite elements); default: as in the file, fdm")
      ->option_text("METHOD")
      ->check(CLI::IsMember({"fdm", "fem"}));
  solve
      ->add_option("--divisions", arguments.divisions,
                   "Of each side, 4 to 200 (non-linear: to " + std::to_string(physics::kMostNonlinearDivisions) + ")")
      ->option_text("N")
      ->check(cli::whole_number_between(physics::Grid::kMinDivisions, physics::Grid::kMaxDivisions));
  solve->add_flag("--nonlinear", arguments.is_nonlinear, "Von Karman: the plate stiffens by stretching");
  add_json(*solve, arguments);
  add_plot(*solve, arguments, "Draw the deflection");
}

void add_thesis(CommandTree& tree) {
  CLI::App* thesis = add_command(tree, tree.line.app, "thesis", "Compute a table of the thesis anew and show it beside what is printed",
                                 "dtslab thesis 3.2 | deflections of the acrylic plate\n"
                                 "dtslab thesis 4.1 | where fifteen loads are seen\n"
                                 "dtslab thesis 6.2 | ten healthy volunteers by two networks, with simulated people\n"
                                 "dtslab thesis all --json | all tables, for a program\n",
                                 run_thesis);
  thesis->add_option("TABLE", tree.arguments.table, "3.2, 3.3, 3.4, 3.5, 3.6, 4.1, 5.2, 6.2, 6.3, 6.4 or all")
      ->required()
      ->option_text(" ");
  add_json(*thesis, tree.arguments);
}

CLI::Option* add_estimator(CLI::App& command, Arguments& arguments, const std::vector<std::string>& names) {
  return command.add_option("--estimator", arguments.estimator, core::join(names) + "; default: poly3")
      ->option_text("NAME")
      ->check(CLI::IsMember(names));
}

void add_cop_evaluate(CommandTree& tree, CLI::App& cop) {
  Arguments& arguments = tree.arguments;
  CLI::App* evaluate = add_command(tree, cop, "evaluate", "Map the error of an estimator over the model of a rig's plate",
                                   "dtslab cop evaluate | the thesis's platform, poly3, without noise\n"
                                   "dtslab cop evaluate --estimator thesis --noise realistic --plot map.svg | one noisy scan per place\n"
                                   "dtslab cop evaluate --loads 240 490 700 --json | at several loads\n"
                                   "dtslab cop evaluate --rig rig.toml --contact two-feet | under random stances\n",
                                   run_cop_evaluate);
  evaluate->add_option("--rig", arguments.rig, "Rig file; default: the thesis's floor platform")->option_text("FILE");
  add_estimator(*evaluate, arguments, {"poly3", "thesis", "thesis_per_pair", "moment", "model"});
  evaluate->add_option("--noise", arguments.noise, "none, or realistic: one filtered scan of a real sensor; default: none")
      ->option_text("NOISE")
      ->check(CLI::IsMember({"none", "realistic"}));
  evaluate->add_option("--loads", arguments.loads_n, "Loads; feet: lightest and heaviest person. Default: 490, feet 300 900")
      ->option_text("N ...")
      ->check(cli::number_between(1.0, 2000.0, "newtons"));
  evaluate->add_option("--contact", arguments.contact, "points, one-foot or two-feet (random stances); default: points")
      ->option_text("CONTACT")
      ->check(CLI::IsMember({"points", "one-foot", "two-feet"}));
  add_linear(*evaluate, arguments);
  add_json(*evaluate, arguments);
  add_plot(*evaluate, arguments, "Draw the error of the first load");
}

void add_cop(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* cop = cli::add_group(tree.line.app, "cop", "Calibrate and judge estimators of the centre of pressure",
                                 "dtslab cop fit points.csv --rig rig.toml --out cal.toml | a calibration from known loads\n"
                                 "dtslab cop evaluate --noise realistic | what to expect of a platform\n");
  CLI::App* fit = add_command(tree, *cop, "fit", "Calibrate an estimator with known loads",
                              "dtslab cop fit points.csv --rig rig.toml --out cal.toml | poly3\n"
                              "dtslab cop fit points.csv --rig rig.toml --estimator thesis --out cal.toml | as in thesis 4.4\n",
                              run_cop_fit);
  fit->add_option("POINTS.csv", arguments.points, "Columns p_n,x_mm,y_mm,w1_mm,w2_mm,... one per sensor; corner origin")
      ->required()
      ->option_text(" ");
  fit->add_option("--rig", arguments.rig, "Rig file with plate and sensors")->option_text("FILE")->required();
  add_estimator(*fit, arguments, {"poly3", "thesis", "thesis_per_pair", "moment"});
  fit->add_option("--out", arguments.out, "Calibration to write")->option_text("CAL.toml")->required();
  add_json(*fit, arguments);

  CLI::App* estimate =
      add_command(tree, *cop, "estimate", "Apply a calibration to deflections",
                  "dtslab cop estimate cal.toml points.csv --out est.csv | adds est_x_mm,est_y_mm,est_p_n,flags\n", run_cop_estimate);
  estimate->add_option("CAL.toml", arguments.calibration, "Calibration, as cop fit writes it")->required()->option_text(" ");
  estimate->add_option("POINTS.csv", arguments.points, "Columns w1_mm,w2_mm,...; others are kept")->required()->option_text(" ");
  estimate->add_option("--out", arguments.out, "File to write")->option_text("EST.csv")->required();
  add_cop_evaluate(tree, *cop);
}

void add_compare(CommandTree& tree) {
  CLI::App* compare =
      add_command(tree, tree.line.app, "compare", "Align two recordings of the centre of pressure and tell how far apart they are",
                  "dtslab compare plate.csv force_plate.csv | as thesis Table 4.2\n"
                  "dtslab compare session.xdf force_plate.csv --json | a recording of dtsd, for a program\n",
                  run_compare);
  compare
      ->add_option("A", tree.arguments.first, "XDF recording, or CSV with t_s,x_mm,y_mm (or ml_mm,ap_mm) and, if there, trigger or marker")
      ->required()
      ->option_text(" ");
  compare->add_option("B", tree.arguments.second, "The same; rate and clock may differ")->required()->option_text(" ");
  add_json(*compare, tree.arguments);
}

void add_replay(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* replay = add_command(tree, tree.line.app, "replay", "Compute a recording again and compare every derived stream bit for bit",
                                 "dtslab replay session.xdf | by the rig that the file describes\n"
                                 "dtslab replay session.xdf --json | with scans per second, for a program\n"
                                 "dtslab replay session.xdf --rig rig.toml | by another rig: where would it differ?\n",
                                 run_replay);
  replay->add_option("FILE.xdf", arguments.first, "Recording of dtsd")->required()->option_text(" ");
  replay->add_option("--speed", arguments.speed, "max: as fast as it computes, the default")
      ->option_text("max")
      ->check(CLI::IsMember({"max"}));
  replay->add_option("--rig", arguments.rig, "Rig file; default: the rig that the recording describes")->option_text("FILE");
  add_json(*replay, arguments);
}

void add_simulate(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* simulate =
      add_command(tree, tree.line.app, "simulate", "Record a simulated person: synthetic data with known truth",
                  "dtslab simulate floor --duration 60 --out standing.xdf | a minute of quiet standing\n"
                  "dtslab simulate floor --duration 60 --rate 100 --seed 7 --out standing.xdf --truth truth.csv | and where the "
                  "centre of pressure really was\n"
                  "dtslab simulate chair --duration 60 --out reaching.xdf --truth reaches.csv | somebody who reaches now and then\n",
                  run_simulate);
  simulate->add_option("KIND", arguments.kind, "floor or chair")->required()->option_text(" ")->check(CLI::IsMember({"floor", "chair"}));
  simulate->add_option("--duration", arguments.duration_s, "Length of the recording")
      ->option_text("S")
      ->required()
      ->check(cli::number_between(0.1, 86400.0, "seconds"));
  simulate->add_option("--rate", arguments.rate_hz, "Scans per second; default: the rig's, floor 100, chair 1500")
      ->option_text("HZ")
      ->check(cli::number_between(1.0, 20000.0, "hertz"));
  simulate->add_option("--seed", arguments.seed, "The same seed gives the same data; default: 1")
      ->option_text("N")
      ->check(cli::whole_number_between(0, 4294967295));
  simulate->add_option("--out", arguments.out, "Recording to write")->option_text("FILE.xdf")->required();
  simulate
      ->add_option("--truth", arguments.truth, "Write the truth too. Floor: t_s,true_ml_mm,true_ap_mm,true_load_n; chair: one row a reach")
      ->option_text("TRUTH.csv");
  simulate->add_option("--rig", arguments.rig, "Rig file; default: the thesis's floor platform or chair")->option_text("FILE");
  add_json(*simulate, arguments);
}

void add_place(CommandTree& tree) {
  Arguments& arguments = tree.arguments;
  CLI::App* place = add_command(tree, tree.line.app, "place", "Find the best places for the sensors under a rig's plate",
                                "dtslab place | four sensors under the thesis's platform\n"
                                "dtslab place --rig rig.toml --sensors 16 --json | sixteen under another\n"
                                "dtslab place --plot place.svg | accuracy over the distance from the edges\n",
                                run_place);
  place->add_option("--rig", arguments.rig, "Rig file; default: the thesis's floor platform")->option_text("FILE");
  place->add_option("--sensors", arguments.sensor_count, "4, 8 or 16; default: 4")->option_text("N")->check(CLI::IsMember({4, 8, 16}));
  add_linear(*place, arguments);
  add_json(*place, arguments);
  add_plot(*place, arguments, "Draw the figures");
}

}  // namespace

CLI::App* add_command(CommandTree& tree, CLI::App& parent, const std::string& name, const std::string& description,
                      const std::string& examples, Command handler) {
  return cli::add_command(tree.line, parent, name, description, examples,
                          [&tree, handler](cli::Console& console) { return handler(tree.arguments, console); });
}

void add_json(CLI::App& command, Arguments& arguments) { command.add_flag("--json", arguments.is_json, "Print one JSON document"); }

std::unique_ptr<CommandTree> make_command_tree() {
  auto owner = std::make_unique<CommandTree>();
  CommandTree& tree = *owner;
  tree.line.manual = make_manual();
  add_plate(tree);
  add_thesis(tree);
  add_cop(tree);
  add_compare(tree);
  add_place(tree);
  add_replay(tree);
  add_simulate(tree);
  add_reach(tree);
  add_sway(tree);
  cli::add_common(tree.line);
  return owner;
}

}  // namespace dts::lab
