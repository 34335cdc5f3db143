// SPDX-License-Identifier: Apache-2.0
#include "lab/simulate_command.h"

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "files/rig_file.h"
#include "lab/problems.h"
#include "lab/simulate.h"
#include "lab/simulated_rig.h"

namespace dts::lab {
namespace {

constexpr double kFloorRateHz = 100.0;   // thesis 4.6
constexpr double kChairRateHz = 1500.0;  // thesis 6.3.2

core::Result<Simulation> make_simulation(const Arguments& arguments, files::Problems& problems) {
  Simulation simulation{.duration_s = arguments.duration_s, .seed = arguments.seed, .out = arguments.out, .truth = arguments.truth};
  const bool is_chair = arguments.kind == "chair";
  if (arguments.rig.empty()) {
    simulation.definition =
        is_chair ? chair_definition(arguments.rate_hz.value_or(kChairRateHz)) : floor_definition(arguments.rate_hz.value_or(kFloorRateHz));
    simulation.config = files::read_rig_text(simulation.definition, is_chair ? "the chair" : "the thesis's floor platform", problems);
  } else {
    simulation.config = files::read_rig_file(arguments.rig, problems);
    if (!problems.empty()) return simulation;
    auto definition = files::rig_definition(arguments.rig);
    if (!definition) return tl::make_unexpected(definition.error());
    simulation.definition = std::move(*definition);
  }
  if (simulation.config.kind != arguments.kind) {
    return core::fail(core::ErrorCode::InvalidArgument, arguments.rig + " is a rig of the kind " + simulation.config.kind,
                      "dtslab simulate " + simulation.config.kind);
  }
  simulation.config.name = arguments.kind;
  if (!arguments.rate_hz) return simulation;
  auto rate = core::Rate::from_hz(*arguments.rate_hz);
  if (!rate) return tl::make_unexpected(rate.error());
  simulation.config.rate = *rate;
  return simulation;
}

}  // namespace

int run_simulate(const Arguments& arguments, cli::Console& console) {
  files::Problems problems;
  auto simulation = make_simulation(arguments, problems);
  if (!problems.empty()) return report_problems(console, problems);
  if (!simulation) return fail_with(console, simulation.error());
  core::Result<Simulated> simulated;
  {
    cli::Progress progress(console, "simulating");
    simulated = simulate_rig(std::move(*simulation), [&progress](double done) { progress.report(done); });
  }
  if (!simulated) return fail_with(console, simulated.error());
  if (arguments.is_json) {
    console.out << cli::document(
        {{"file", simulated->file}, {"scans", simulated->scans}, {"bytes", simulated->bytes}, {"sha256", simulated->sha256}});
  } else {
    console.out << simulated->file << ": " << simulated->scans << " scans, " << simulated->bytes << " bytes\n";
  }
  cli::print_hint(console, "dtslab replay " + simulated->file);
  return cli::kOk;
}

}  // namespace dts::lab
