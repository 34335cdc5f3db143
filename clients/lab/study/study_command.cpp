// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study_command.h"

#include <cstdint>
#include <string>

#include "cli/exit_status.h"
#include "cli/progress.h"
#include "lab/base/command.h"
#include "lab/base/gnuplot.h"
#include "lab/base/problems.h"
#include "lab/study/study_plot.h"
#include "lab/study/study_view.h"

namespace dts::lab::study {

namespace {

struct Arguments {
  std::uint32_t seed = 1;  ///< Of the first draw.
  std::string plot;        ///< Output file for a picture; empty: none.
  bool is_json = false;
};

int run_reach_study(const Arguments& arguments, cli::Console& console) {
  if (!arguments.plot.empty()) {
    if (const auto name = check_plot_name(arguments.plot); !name) return fail_with(console, name.error());  // fail now, not after minutes
  }
  core::Result<std::vector<Draw>> draws;
  {
    cli::Progress progress(console, "simulating people");
    progress.tick_by_itself();
    draws = run_study({.seed = arguments.seed}, [&progress](double done) { progress.report(done); });
  }
  if (!draws) return fail_with(console, draws.error());
  if (!arguments.plot.empty()) {
    if (const auto drawn = draw_study(middle_draw(*draws), arguments.plot); !drawn) return fail_with(console, drawn.error());
  }
  if (arguments.is_json) {
    console.out << cli::document(to_json(*draws));
  } else {
    print(*draws, console);
  }
  return cli::kOk;
}

}  // namespace

void add_commands(cli::CommandLine& line, CLI::App& reach) {
  const auto [command, arguments] =
      add_command(line, reach, "study", "Repeat the experiments of chapters 5 and 6 of the thesis with simulated people, beside the printed values",
                  "dtslab reach study | five draws of eighteen people; takes half a minute\n"
                  "dtslab reach study --seed 7 --plot study.svg | other people; also draw confusions and trunk angles\n"
                  "dtslab reach study --json | every confusion of every draw, for a program\n",
                  run_reach_study);
  add_seed(command, arguments.seed, "Of the first draw; the same seed gives the same people");
  add_plot(command, arguments.plot, "Draw the confusions of the draw in the middle and the trunk angles");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::study
