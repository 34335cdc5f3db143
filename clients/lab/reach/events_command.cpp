// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/events_command.h"

#include <algorithm>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "lab/base/command.h"
#include "lab/base/gnuplot.h"
#include "lab/base/problems.h"
#include "lab/reach/predictions.h"
#include "lab/reach/reach_plot.h"
#include "lab/reach/trial_set.h"

namespace dts::lab::reach {
namespace {

struct EventsArguments {
  std::string folder;
  std::string out;
  std::string plot;  ///< Output file for a picture; empty: none.
  bool is_json = false;
};

using Reaches = std::vector<std::optional<core::ReachEvent>>;

Reaches find_with_progress(const TrialSet& set, cli::Console& console) {
  cli::Progress progress(console, "finding reaches");
  return find_reaches(set, [&progress](double done) { progress.report(done); });
}

std::vector<Prediction> predictions_of(const TrialSet& set, const Reaches& reaches) {
  std::vector<Prediction> predictions;
  for (std::size_t k = 0; k < set.trials.size(); ++k) {
    const Trial& trial = set.trials[k];
    predictions.push_back({.subject = set.subjects[trial.subject].name,
                           .trial = trial.number,
                           .rate = trial.rate,
                           .reach = reaches[k],
                           .movement = std::nullopt});
  }
  return predictions;
}

std::size_t count_with(const Reaches& reaches, unsigned flags) {
  return static_cast<std::size_t>(
      std::ranges::count_if(reaches, [flags](const auto& reach) { return reach && (reach->flags & flags) != 0; }));
}

void print_summary(const Reaches& reaches, const EventsArguments& arguments, cli::Console& console) {
  constexpr unsigned kDoubts = core::reach_flag::kBaselineUncertain | core::reach_flag::kTimeout | core::reach_flag::kSubstituted |
                               core::reach_flag::kSaturated | core::reach_flag::kImplausible | core::reach_flag::kStoodUp |
                               core::reach_flag::kUntared;
  const auto found = static_cast<std::size_t>(std::ranges::count_if(reaches, [](const auto& reach) { return reach.has_value(); }));
  const std::size_t minor = count_with(reaches, core::reach_flag::kMinor | core::reach_flag::kDipOnly);
  const std::size_t doubtful = count_with(reaches, kDoubts);
  if (arguments.is_json) {
    console.out << cli::document(
        {{"file", arguments.out}, {"trials", reaches.size()}, {"reaches", found}, {"minor", minor}, {"doubtful", doubtful}});
    return;
  }
  console.out << arguments.out << ": " << reaches.size() << " trials, " << found << " with a reach, of these " << minor << " minor and "
              << doubtful << " doubtful\n";
}

int run_events(const EventsArguments& arguments, cli::Console& console) {
  if (!arguments.plot.empty()) {
    if (const auto status = check_plot_name(arguments.plot); !status) return fail_with(console, status.error());
  }
  if (const auto free = check_out(arguments.out, {arguments.folder}); !free) return fail_with(console, free.error());
  files::Problems problems;
  const TrialSet set = read_trial_set(arguments.folder, problems);
  if (!problems.empty()) return report_problems(console, problems);
  const Reaches reaches = find_with_progress(set, console);
  if (const auto written = write_predictions(predictions_of(set, reaches), arguments.out); !written) {
    return fail_with(console, written.error());
  }
  if (!arguments.plot.empty()) {
    if (const auto drawn = plot_reaches(set, reaches, arguments.plot); !drawn) return fail_with(console, drawn.error());
  }
  print_summary(reaches, arguments, console);
  return cli::kOk;
}

}  // namespace

CLI::Option* add_folder(CLI::App& command, std::string& folder) {
  return command.add_option("DIR", folder, "Folder of trials: subjects.csv, trials.csv, sensors.csv, calibration.csv and the files with volts")
      ->option_text(" ");
}

CLI::App& add_commands(cli::CommandLine& line) {
  CLI::App* reach = cli::add_group(line.app, "reach", "Find and classify reaches on the chair",
                                   "dtslab reach events trials/ --out pred.csv | P1, P2 and P3 of each trial\n"
                                   "dtslab reach train trials/ --out model.toml | a model of trunk movement\n");
  const auto [command, arguments] =
      add_command(line, *reach, "events", "Find the reach of each trial: the points P1, P2 and P3 of its transient",
                  "dtslab reach events trials/ --out pred.csv | times in s from each trial's first sample\n"
                  "dtslab reach events trials/ --out pred.csv --plot reaches.svg | also draw one trial per condition\n",
                  run_events);
  add_folder(command, arguments.folder)->required();
  command.add_option("--out", arguments.out, "CSV file to write; the columns of class and trunk stay empty")
      ->option_text("PRED.csv")
      ->required();
  add_plot(command, arguments.plot, "Draw the first trial of each condition");
  add_json(command, arguments.is_json);
  return *reach;
}

}  // namespace dts::lab::reach
