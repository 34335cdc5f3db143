// SPDX-License-Identifier: Apache-2.0
#include "lab/command_tree.h"

#include "lab/compare/compare_command.h"
#include "lab/cop/cop_command.h"
#include "lab/force/force_commands.h"
#include "lab/manual.h"
#include "lab/place/place_command.h"
#include "lab/plate/plate_command.h"
#include "lab/reach/events_command.h"
#include "lab/replay/replay_command.h"
#include "lab/resolution/resolution_command.h"
#include "lab/results/recorded_reaches_command.h"
#include "lab/simulate/simulate_command.h"
#include "lab/steadiness/steadiness_commands.h"
#include "lab/study/study_command.h"
#include "lab/sway/sway_command.h"
#include "lab/thesis/thesis_command.h"
#include "lab/training/training_commands.h"

namespace dts::lab {

std::unique_ptr<cli::CommandLine> make_command_tree() {
  auto owner = std::make_unique<cli::CommandLine>(
      cli::Program{.name = "dtslab",
                   .version = DTS_VERSION,
                   .description = "Offline laboratory of dtsd: plates, centre of pressure, the thesis's tables",
                   .examples = "dtslab plate solve case.toml | bend a plate\n"
                               "dtslab thesis 4.1 | compare our values with the thesis\n"
                               "dtslab cop fit points.csv --rig rig.toml --out cal.toml | calibrate a platform\n"
                               "dtslab cop evaluate --noise realistic | expected error of a platform\n"
                               "dtslab compare plate.csv force_plate.csv | compare two instruments\n"
                               "dtslab place | best sensor positions\n"
                               "dtslab sway standing.csv | measure sway\n"
                               "dtslab simulate floor --duration 60 --out standing.xdf | make synthetic data\n"
                               "dtslab replay standing.xdf | check that the recorded values can be recomputed\n",
                   .takes_files = true});
  cli::CommandLine& line = *owner;
  line.manual = make_manual();
  plate::add_commands(line);
  thesis::add_commands(line);
  cop::add_commands(line);
  force::add_commands(line);
  compare::add_commands(line);
  place::add_commands(line);
  replay::add_commands(line);
  simulate::add_commands(line);
  CLI::App& reaches = reach::add_commands(line);
  training::add_commands(line, reaches);
  study::add_commands(line, reaches);
  resolution::add_commands(line, reaches);
  results::add_commands(line, reaches);
  sway::add_commands(line);
  steadiness::add_commands(line);
  cli::add_common(line);
  return owner;
}

}  // namespace dts::lab
