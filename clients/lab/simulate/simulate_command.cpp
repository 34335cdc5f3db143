// SPDX-License-Identifier: Apache-2.0
#include "lab/simulate/simulate_command.h"

#include <cstdint>
#include <optional>
#include <string>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/validators.h"
#include "files/rig_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/simulate/simulate.h"
#include "lab/simulate/simulated_rig.h"

namespace dts::lab::simulate {
namespace {

struct Arguments {
  std::string kind;  ///< Of rig: "floor", "chair".
  double duration_s = 0.0;
  std::optional<double> rate_hz;  ///< Absent: rate of the rig.
  std::uint32_t seed = 1;
  std::string out;
  std::string truth;  ///< CSV to write; empty: none.
  std::string rig;    ///< Rig file; empty: the thesis's floor platform or chair.
  bool is_json = false;
};

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
    DTS_TRY_ASSIGN(simulation.definition, files::rig_definition(arguments.rig));
  }
  if (simulation.config.kind != arguments.kind) {
    return core::fail(core::ErrorCode::InvalidArgument, arguments.rig + " is a rig of the kind " + simulation.config.kind,
                      "dtslab simulate " + simulation.config.kind);
  }
  simulation.config.name = arguments.kind;
  if (!arguments.rate_hz) return simulation;
  DTS_TRY_ASSIGN(simulation.config.rate, core::Rate::from_hz(*arguments.rate_hz));
  return simulation;
}

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

}  // namespace

void add_commands(cli::CommandLine& line) {
  const auto [command, arguments] =
      add_command(line, line.app, "simulate", "Record a simulated person: synthetic data with known true values",
                  "dtslab simulate floor --duration 60 --out standing.xdf | one minute of quiet standing\n"
                  "dtslab simulate floor --duration 60 --rate 100 --seed 7 --out standing.xdf --truth truth.csv | also write the true "
                  "centre of pressure\n"
                  "dtslab simulate chair --duration 60 --out reaching.xdf --truth reaches.csv | a person who reaches several times\n",
                  run_simulate);
  command.add_option("KIND", arguments.kind, "floor or chair")->required()->option_text(" ")->check(CLI::IsMember({"floor", "chair"}));
  command.add_option("--duration", arguments.duration_s, "Duration of the recording, seconds")
      ->option_text("S")
      ->required()
      ->check(cli::number_between(0.1, 86400.0, "seconds"));
  command.add_option("--rate", arguments.rate_hz, "Scans per second; default: the rig's, floor 100, chair 1500")
      ->option_text("HZ")
      ->check(cli::number_between(1.0, 20000.0, "hertz"));
  add_seed(command, arguments.seed, "The same seed gives the same data");
  command.add_option("--out", arguments.out, "Recording file to write")->option_text("FILE.xdf")->required();
  command
      .add_option("--truth", arguments.truth,
                  "CSV file for the true values. Floor: t_s,true_ml_mm,true_ap_mm,true_load_n; chair: one row per reach")
      ->option_text("TRUTH.csv");
  add_rig(command, arguments.rig, "Rig file; default: the thesis's floor platform or chair");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::simulate
