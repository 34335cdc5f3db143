// SPDX-License-Identifier: Apache-2.0
#include "lab/study/study_command.h"

#include "cli/exit_status.h"
#include "cli/progress.h"
#include "lab/gnuplot.h"
#include "lab/problems.h"
#include "lab/study/study_plot.h"
#include "lab/study/study_view.h"

namespace dts::lab {

int run_reach_study(const Arguments& arguments, cli::Console& console) {
  if (!arguments.plot.empty()) {
    if (const auto name = check_plot_name(arguments.plot); !name) return fail_with(console, name.error());  // fail now, not after minutes
  }
  core::Result<std::vector<study::Draw>> draws;
  {
    cli::Progress progress(console, "simulating people");
    progress.tick_by_itself();
    draws = study::run_study({.seed = arguments.seed}, [&progress](double done) { progress.report(done); });
  }
  if (!draws) return fail_with(console, draws.error());
  if (!arguments.plot.empty()) {
    if (const auto drawn = study::draw_study(study::middle_draw(*draws), arguments.plot); !drawn) return fail_with(console, drawn.error());
  }
  if (arguments.is_json) {
    console.out << cli::document(study::to_json(*draws));
  } else {
    study::print(*draws, console);
  }
  return cli::kOk;
}

}  // namespace dts::lab
