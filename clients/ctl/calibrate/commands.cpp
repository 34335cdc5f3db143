// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/commands.h"

#include "cli/validators.h"
#include "ctl/calibrate/cop_command.h"
#include "ctl/calibrate/sensor_command.h"
#include "files/toml_reader.h"

namespace dts::ctl {
namespace {

void add_common_options(CLI::App& command, CalibrateArguments& wishes) {
  command
      .add_option("--out", wishes.out, "File to write; an existing file is never overwritten. Default: RIG-...-DATE.toml in this folder")
      ->option_text("FILE");
  command.add_option("--hold", wishes.hold_s, "Seconds of rest that each reading averages. Default: 3")
      ->option_text("S")
      ->check(cli::number_between(0.02, 600.0, "seconds"));
  command.add_flag("--auto", wishes.is_auto, "Ask nothing: the next steady reading is the next point. Works without a terminal");
}

void add_sensor(CommandTree& tree, CLI::App& parent) {
  Arguments& arguments = tree.arguments;
  CalibrateArguments& wishes = arguments.calibrate;
  CLI::App* sensor =
      cli::add_command(tree.line, parent, "sensor", "Measure the curves of sensors: volts at known gaps",
                       "dtsctl calibrate sensor --rig floor --sensor w1 | one sensor, with spacers of 12.5, 12, 11, ... 7, 6.5 mm\n"
                       "dtsctl calibrate sensor --rig floor --sensor all --gaps 13,12,11,10,9,8,7,6.5,7,8,9,10,11,12,13 | all sensors, "
                       "gaps down and up again\n"
                       "dtsctl calibrate sensor --sensor w1 --points w1.csv --out w1.toml | from a file, without measuring\n",
                       [&tree](cli::Console& console) { return run_calibrate_sensor(tree.arguments, console); });
  sensor->add_option("--rig", arguments.rig, "Rig of the sensors; not needed with --points")->option_text("RIG");
  sensor->add_option("--sensor", wishes.sensor, "Label of the sensor; all: every sensor of the rig")
      ->option_text("LABEL")
      ->required()
      ->check(cli::text_of(1, files::kLongestText));
  wishes.gaps_mm = {12.5, 12.0, 11.0, 10.0, 9.0, 8.0, 7.0, 6.5};  // thesis 3.4, extended at both ends: unloaded and 600 N
  sensor
      ->add_option("--gaps", wishes.gaps_mm,
                   "Gaps in mm, in the order of measuring; repeated gaps are averaged. Default: 12.5,12,11,10,9,8,7,6.5")
      ->option_text("MM,MM,...")
      ->delimiter(',')
      ->check(cli::number_between(0.1, 1000.0, "mm"));
  sensor->add_option("--points", wishes.points_file, "Read the points from a CSV file with the columns gap_mm,volts instead of measuring")
      ->option_text("FILE");
  add_common_options(*sensor, wishes);
}

void add_cop(CommandTree& tree, CLI::App& parent) {
  Arguments& arguments = tree.arguments;
  CalibrateArguments& wishes = arguments.calibrate;
  CLI::App* cop = cli::add_command(tree.line, parent, "cop", "Calibrate the centre of pressure with known weights at known positions",
                                   "dtsctl calibrate cop --rig floor | 7 x 7 positions, with 240 N and with 600 N\n"
                                   "dtsctl calibrate cop --rig floor --estimator thesis --loads 490 | five positions on each mid-line\n"
                                   "dtsctl calibrate cop --rig floor --resume | continue after an interruption\n",
                                   [&tree](cli::Console& console) { return run_calibrate_cop(tree.arguments, console); });
  cop->add_option("--rig", arguments.rig, "Rig to calibrate")->option_text("RIG")->required();
  cop->add_option("--estimator", wishes.estimator, "poly3 (a grid at two loads) or thesis (mid-lines at one load). Default: poly3")
      ->option_text("NAME")
      ->check(CLI::IsMember({"poly3", "thesis"}));
  cop->add_option("--loads", wishes.loads_n,
                  "Weights in N; the estimator thesis needs exactly one. Default: 240,600 for poly3, 490 for thesis")
      ->option_text("N,N,...")
      ->delimiter(',')
      ->check(cli::number_between(1.0, 5000.0, "newtons"));
  cop->add_option("--grid", wishes.grid, "Positions per side, poly3 only. Default: 7")
      ->option_text("N")
      ->check(cli::whole_number_between(4, 15));
  cop->add_option("--verify", wishes.verify, "Verify at N of the 15 points of thesis Table 4.1; 0: no verification. Default: 15")
      ->option_text("N")
      ->check(cli::whole_number_between(0, 15));
  CLI::Option* resume = cop->add_flag("--resume", wishes.is_resumed, "Continue an interrupted calibration with its own points and options");
  cop->add_flag("--fresh", wishes.is_fresh, "Delete the points of an interrupted calibration and start again")->excludes(resume);
  add_common_options(*cop, wishes);
}

}  // namespace

void add_calibrate(CommandTree& tree) {
  CLI::App* calibrate = cli::add_group(tree.line.app, "calibrate", "Calibrate the sensors and the plate of a rig",
                                       "dtsctl calibrate sensor --rig floor --sensor all | the curves of all sensors, with spacers\n"
                                       "dtsctl calibrate cop --rig floor | the centre of pressure, with weights\n");
  add_sensor(tree, *calibrate);
  add_cop(tree, *calibrate);
}

}  // namespace dts::ctl
