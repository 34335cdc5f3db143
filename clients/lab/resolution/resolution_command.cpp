// SPDX-License-Identifier: Apache-2.0
#include "lab/resolution/resolution_command.h"

#include <string>

#include "cli/exit_status.h"
#include "cli/progress.h"
#include "lab/base/command.h"
#include "lab/base/gnuplot.h"
#include "lab/base/problems.h"
#include "lab/resolution/resolution_view.h"

namespace dts::lab::resolution {
namespace {

struct Arguments {
  ResolutionOptions options;
  std::uint32_t seed = 1;
  std::string plot;  ///< Output file for a picture; empty: none.
  bool is_json = false;
};

int run_reach_resolution(const Arguments& arguments, cli::Console& console) {
  if (!arguments.plot.empty()) {
    if (const auto name = check_plot_name(arguments.plot); !name) return fail_with(console, name.error());  // fail now, not after minutes
  }
  ResolutionOptions options = arguments.options;
  options.seed = arguments.seed;
  core::Result<Resolution> resolution;
  {
    cli::Progress progress(console, "simulating reaches");
    progress.tick_by_itself();
    resolution = find_resolution(options, [&progress](double done) { progress.report(done); });
  }
  if (!resolution) return fail_with(console, resolution.error());
  if (!arguments.plot.empty()) {
    if (const auto drawn = draw_curves(picture_of(*resolution), arguments.plot); !drawn) return fail_with(console, drawn.error());
  }
  if (arguments.is_json) {
    console.out << cli::document(to_json(*resolution));
  } else {
    print(*resolution, console);
  }
  return cli::kOk;
}

}  // namespace

void add_commands(cli::CommandLine& line, CLI::App& reach) {
  const auto [command, arguments] =
      add_command(line, reach, "resolution", "Find the smallest trunk movement that the chair distinguishes from none, on simulated people",
                  "dtslab reach resolution | three noises, 100 and 1500 Hz, eight people; takes some minutes\n"
                  "dtslab reach resolution --noise 3 --rate 100 --people 40 | one setup, more people\n"
                  "dtslab reach resolution --plot resolution.svg | also draw the smallest movement over the noise\n",
                  run_reach_resolution);
  command
      .add_option("--noise", arguments.options.noises_mv, "Noise of one scan of a sensor (mV rms), separated by commas. Default: 1,3,10")
      ->option_text("MV,...")
      ->delimiter(',');
  command.add_option("--rate", arguments.options.rates_hz, "Rates (Hz), separated by commas. Default: 100,1500")
      ->option_text("HZ,...")
      ->delimiter(',');
  command.add_option("--people", arguments.options.people, "Number of people. Default: 8")->option_text("N");
  command.add_option("--reaches", arguments.options.reaches, "Reaches of each person at each turn of the trunk. Default: 15")
      ->option_text("N");
  add_seed(command, arguments.seed, "The same seed gives the same people");
  add_plot(command, arguments.plot, "Draw the smallest movement over the noise");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::resolution
