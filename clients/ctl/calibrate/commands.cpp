// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/commands.h"

#include "cli/validators.h"
#include "ctl/calibrate/cop_command.h"
#include "ctl/calibrate/sensor_command.h"

namespace dts::ctl {
namespace {

void add_common_options(CLI::App& command, CalibrateArguments& wishes) {
  command.add_option("--out", wishes.out, "File to write (RIG-...-DATE.toml here); never overwritten")->option_text("FILE");
  command.add_option("--hold", wishes.hold_s, "Average over S seconds of rest (3)")
      ->option_text("S")
      ->check(cli::number_between(0.02, 600.0, "seconds"));
  command.add_flag("--auto", wishes.is_auto, "Ask nothing: whatever comes to rest next is the next one; also without a terminal");
}

void add_sensor(CommandTree& tree, CLI::App& parent) {
  Arguments& arguments = tree.arguments;
  CalibrateArguments& wishes = arguments.calibrate;
  CLI::App* sensor =
      cli::add_command(tree.line, parent, "sensor", "Measure sensors' curves: volts over known gaps",
                       "dtsctl calibrate sensor --rig floor --sensor w1 | spacers of 12.5, 12, 11, ... 7, 6.5 mm before one sensor\n"
                       "dtsctl calibrate sensor --rig floor --sensor all --gaps 13,12,11,10,9,8,7,6.5,7,8,9,10,11,12,13 | there and back\n"
                       "dtsctl calibrate sensor --sensor w1 --points w1.csv --out w1.toml | from a table gap_mm,volts\n",
                       [&tree](cli::Console& console) { return run_calibrate_sensor(tree.arguments, console); });
  sensor->add_option("--rig", arguments.rig, "Rig of the sensors; not needed with --points")->option_text("RIG");
  sensor->add_option("--sensor", wishes.sensor, "Label of the sensor, or all")->option_text("LABEL")->required();
  wishes.gaps_mm = {12.5, 12.0, 11.0, 10.0, 9.0, 8.0, 7.0, 6.5};  // thesis 3.4, extended at both ends: unloaded and 600 N
  sensor
      ->add_option("--gaps", wishes.gaps_mm, "Gaps in mm, in the order of measuring (12.5,12,11,10,9,8,7,6.5); repeated ones are averaged")
      ->option_text("MM,MM,...")
      ->delimiter(',')
      ->check(cli::number_between(0.1, 1000.0, "mm"));
  sensor->add_option("--points", wishes.points_file, "Measure nothing: CSV file gap_mm,volts")->option_text("FILE");
  add_common_options(*sensor, wishes);
}

void add_cop(CommandTree& tree, CLI::App& parent) {
  Arguments& arguments = tree.arguments;
  CalibrateArguments& wishes = arguments.calibrate;
  CLI::App* cop = cli::add_command(tree.line, parent, "cop", "Calibrate the centre of pressure with known weights at known places",
                                   "dtsctl calibrate cop --rig floor | 7 x 7 places with 240 and with 600 N\n"
                                   "dtsctl calibrate cop --rig floor --estimator thesis --loads 490 | five places on each mid-line\n"
                                   "dtsctl calibrate cop --rig floor --resume | go on after an interruption\n",
                                   [&tree](cli::Console& console) { return run_calibrate_cop(tree.arguments, console); });
  cop->add_option("--rig", arguments.rig, "Rig to calibrate")->option_text("RIG")->required();
  cop->add_option("--estimator", wishes.estimator, "poly3 (a grid at two loads) or thesis (mid-lines at one load)")
      ->option_text("NAME")
      ->check(CLI::IsMember({"poly3", "thesis"}));
  cop->add_option("--loads", wishes.loads_n, "Weights in N (poly3: 240,600; thesis: 490, exactly one)")
      ->option_text("N,N,...")
      ->delimiter(',')
      ->check(cli::number_between(1.0, 5000.0, "newtons"));
  cop->add_option("--grid", wishes.grid, "Places per side for poly3 (7)")->option_text("N")->check(cli::whole_number_between(4, 15));
  cop->add_option("--verify", wishes.verify, "Verify at N of the 15 points of thesis Table 4.1 (15); 0: not at all")
      ->option_text("N")
      ->check(cli::whole_number_between(0, 15));
  CLI::Option* resume = cop->add_flag("--resume", wishes.is_resumed,
                                      "Go on with the points of an interrupted calibration, with the options it was begun with");
  cop->add_flag("--fresh", wishes.is_fresh, "Forget the points of an interrupted calibration")->excludes(resume);
  add_common_options(*cop, wishes);
}

}  // namespace

void add_calibrate(CommandTree& tree) {
  CLI::App* calibrate = cli::add_group(tree.line.app, "calibrate", "Measure what the rig's files say about sensors and plate",
                                       "dtsctl calibrate sensor --rig floor --sensor all | the sensors' curves, with spacers\n"
                                       "dtsctl calibrate cop --rig floor | the centre of pressure, with weights\n");
  add_sensor(tree, *calibrate);
  add_cop(tree, *calibrate);
}

}  // namespace dts::ctl
