// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_command.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_status.h"
#include "cli/interruption.h"
#include "cli/progress.h"
#include "cli/validators.h"
#include "files/whole_file.h"
#include "lab/base/command.h"
#include "lab/base/figure_json.h"
#include "lab/base/problems.h"
#include "lab/sway/measure_file.h"
#include "lab/sway/sway_comparison.h"
#include "lab/sway/sway_table.h"
#include "lab/sway/sway_view.h"
#include "posturography/cop_series.h"
#include "posturography/measure.h"
#include "session/sway_results.h"

namespace dts::lab::sway {
namespace {

/// The results of all files.
struct MeasuredFiles {
  std::vector<MeasuredTrial> trials;
  std::vector<std::pair<std::string, MeasuredFile>> unwell;  ///< Files that are unreadable or torn.
  int status = cli::kOk;                                     ///< The highest status of the unreadable files.
  std::size_t files = 0;                                     ///< Number of files tried.
  bool is_interrupted = false;
};

MeasuredFiles measure_all(const std::vector<SwayInput>& inputs, const SwayArguments& arguments, cli::Console& console) {
  const cli::Interruption interruption;  // stops between files: tables are written completely or not at all
  cli::Progress progress(console, "measuring");
  MeasuredFiles all;
  for (const SwayInput& input : inputs) {
    const auto report = [&](double part) { progress.report((static_cast<double>(all.files) + part) / static_cast<double>(inputs.size())); };
    report(0.0);
    MeasuredFile measured = measure_file(input, arguments, report);
    all.is_interrupted = interruption.is_asked_for();
    if (all.is_interrupted) return all;
    ++all.files;
    std::ranges::move(measured.trials, std::back_inserter(all.trials));
    measured.trials.clear();
    if (!measured.problems.empty() || measured.error || !measured.damage.empty()) all.unwell.emplace_back(input.file, std::move(measured));
  }
  return all;
}

/// Call after the progress bar has disappeared.
void print_problems(MeasuredFiles& all, cli::Console& console) {
  for (const auto& [file, measured] : all.unwell) {
    if (!measured.problems.empty()) all.status = std::max(all.status, report_problems(console, measured.problems));
    if (measured.error) {
      const bool says_file = measured.error->what.find(file) != std::string::npos;
      const core::Error error{measured.error->code, (says_file ? "" : file + ": ") + measured.error->what, measured.error->hint};
      all.status = std::max(all.status, fail_with(console, error));
    }
    if (!measured.damage.empty()) warn(console, file + ": " + measured.damage);
  }
}

void print_doubts(const std::vector<MeasuredTrial>& trials, const SwayArguments& arguments, cli::Console& console) {
  constexpr double kRateThatNeedsAFilter = 200.0;
  bool is_noisy = false;
  for (const MeasuredTrial& trial : trials) {
    if (!trial.problem.empty()) warn(console, trial.title() + ": " + trial.problem);
    is_noisy = is_noisy || (trial.analysis && arguments.profile == "asis" && trial.analysis->rate_hz > kRateThatNeedsAFilter);
  }
  const auto is_stepping_on = [](const MeasuredTrial& trial) {
    return !trial.session.empty() && trial.trial == 0 && trial.analysis && !trial.analysis->is_valid();
  };
  if (arguments.trim_s == 0.0 && std::ranges::any_of(trials, is_stepping_on)) {
    cli::print_hint(console, "a recording without trials includes the step onto the platform; to exclude it: --trim 5");
  }
  // Sheet section 2: unfiltered at 1000 Hz the mean velocity of a force plate is four times that at 100 Hz.
  if (is_noisy) warn(console, "without a filter at a high rate, path and velocity are mostly sensor noise; use --profile lp10");
  if (arguments.rate_hz && arguments.profile == "asis") {
    warn(console, "--rate has no effect without the filter that prevents aliasing; use --profile lp10");
  }
}

/// Returns the results of a session as dtsd computes them, from the trials of one recording that count.
cli::Json summary(const std::vector<MeasuredTrial>& trials) {
  std::vector<session::SwayTrialResult> counting;
  for (const MeasuredTrial& trial : trials) {
    if (trial.outcome != "done") continue;
    counting.push_back({.trial = trial.trial, .attempt = trial.attempt, .condition = trial.condition, .labels = trial.labels});
    counting.back().analysis = trial.analysis;
  }
  cli::Json json = cli::Json::array();
  for (const session::SessionFigure& figure : session::sway_summary(counting)) json.push_back(figure_json(figure));
  return json;
}

cli::Json documents(const MeasuredFiles& all, const SwayArguments& arguments) {
  cli::Json json{{"trials", cli::Json::array()}};
  std::size_t compared = 0;
  std::size_t differing = 0;
  for (const MeasuredTrial& trial : all.trials) {
    json["trials"].push_back(to_json(trial, arguments));
    if (!trial.is_as_recorded) continue;
    ++compared;
    if (!*trial.is_as_recorded) ++differing;
  }
  if (all.files == 1) json["summary"] = summary(all.trials);
  json["recorded_results"] = compared;
  json["differing_results"] = differing;
  json["problems"] = cli::Json::array();
  for (const auto& [file, measured] : all.unwell) {
    for (const files::Problem& problem : measured.problems) json["problems"].push_back(files::to_string(problem));
    if (measured.error) json["problems"].push_back(file + ": " + core::to_string(*measured.error));
    if (!measured.damage.empty()) json["problems"].push_back(file + ": " + measured.damage);
  }
  return json;
}

/// Returns whether there is one CSV file: contract.md defines its own document for that case.
bool is_single_file(const std::vector<SwayInput>& inputs, const SwayArguments& arguments) {
  return inputs.size() == 1 && arguments.inputs.size() == 1 && inputs.front().file == arguments.inputs.front() &&
         !inputs.front().is_recording();
}

void show(const MeasuredFiles& all, bool is_single, const SwayArguments& arguments, cli::Console& console) {
  if (arguments.is_json) {
    if (is_single && all.trials.empty()) return;  // the problem was reported; there is no such document
    console.out << cli::document(is_single ? to_json(all.trials.front(), arguments) : documents(all, arguments));
    return;
  }
  if (all.trials.size() == 1) print_measures(all.trials.front(), console);
  if (all.trials.size() > 1) {
    print_overview(all.trials, console);
    if (arguments.table.empty()) cli::print_hint(console, "for every measure of every trial, use --table OUT.csv or --json");
  }
  print_live(all.trials, console);
}

int show_comparison(const MeasuredFiles& all, const SwayArguments& arguments, cli::Console& console) {
  std::vector<MeasuredTrial> trials = all.trials;
  std::erase_if(trials, [](const MeasuredTrial& trial) { return !trial.analysis; });
  if (trials.size() != 2) {
    const std::string count = trials.empty() ? "none" : std::to_string(trials.size());
    return std::max(all.status, fail_with(console, core::Error{core::ErrorCode::InvalidArgument,
                                                               "--compare needs exactly two measured trials, not " + count,
                                                               "give two files, or select two trials of a recording: --trials 1,2"}));
  }
  const Comparison comparison = compare(trials[0], trials[1]);
  if (arguments.is_json) {
    cli::Json json{{"first", to_json(trials[0], arguments)}, {"second", to_json(trials[1], arguments)}};
    json["comparison"] = to_json(comparison);
    console.out << cli::document(json);
  } else {
    print(comparison, trials[0], trials[1], console);
  }
  for (const std::string& warning : comparison.warnings) warn(console, warning);
  return all.status;
}

/// Returns the exit status. `all` has trials, or the problems of the files explain why there are none.
int status_of(const MeasuredFiles& all, cli::Console& console) {
  if (all.status != cli::kOk) return all.status;
  const auto is_measured = [](const MeasuredTrial& trial) { return trial.analysis.has_value(); };
  if (!std::ranges::any_of(all.trials, is_measured)) {
    cli::print_error(console, "no valid trial of quiet standing found", "to include rejected trials: --all");
    return cli::kFailed;
  }
  const auto differs = [](const MeasuredTrial& trial) { return !trial.is_as_recorded.value_or(true); };
  return std::ranges::any_of(all.trials, differs) ? cli::kFailed : cli::kOk;
}

core::Status check_table(const std::vector<SwayInput>& inputs, const std::string& table) {
  std::vector<std::string> files;
  for (const SwayInput& input : inputs) files.push_back(input.file);
  return table.empty() ? core::Status{} : check_out(table, files);
}

int run_sway(const SwayArguments& arguments, cli::Console& console) {
  const auto inputs = sway_inputs(arguments);
  if (!inputs) return fail_with(console, inputs.error());
  if (const auto free = check_table(*inputs, arguments.table); !free) return fail_with(console, free.error());
  MeasuredFiles all = measure_all(*inputs, arguments, console);
  print_problems(all, console);
  if (all.is_interrupted) {
    const std::string count = std::to_string(all.files) + " of " + std::to_string(inputs->size());
    cli::print_error(console, "interrupted after " + count + " files; no file was written");
    return cli::kInterrupted;
  }
  print_doubts(all.trials, arguments, console);
  if (!arguments.table.empty() && !all.trials.empty()) {
    const auto written = files::write_whole_file(arguments.table, table_text(all.trials));
    if (!written) return fail_with(console, written.error());
  }
  if (arguments.is_comparing) return show_comparison(all, arguments, console);
  show(all, is_single_file(*inputs, arguments), arguments, console);
  return status_of(all, console);
}

void add_definition(CLI::App& sway, SwayArguments& arguments) {
  sway.add_option("--profile", arguments.profile, "lp10 (low-pass of 10 Hz, zero phase) or asis (no filter); default: lp10")
      ->option_text("NAME")
      ->check(CLI::IsMember({"asis", "lp10"}));
  sway.add_option("--rate", arguments.rate_hz,
                  "Rate of the analysis in Hz (approximate), lp10 only. Default: rate of the CSV file; 100 for recordings, as in dtsd")
      ->option_text("HZ")
      ->check(cli::number_between(10.0, 100000.0, "hertz"));
  sway.add_option("--trim", arguments.trim_s, "Settling time to remove from the start, after filtering. Default: 0")
      ->option_text("S")
      ->check(cli::number_between(0.0, 3600.0, "seconds"));
  sway.add_option("--foot-length", arguments.foot_length_mm, "Foot length, for AP_USE: AP range as a part of the foot length")
      ->option_text("MM")
      ->check(cli::number_between(50.0, 500.0, "millimetres"));
}

/// Returns the glossary of the results, from the tables that also create the results.
std::vector<cli::Glossary> words_of_results() {
  cli::Glossary measures{.title = "Measures", .words = {}};
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const posturography::MeasureInfo& about = posturography::info(static_cast<posturography::Measure>(k));
    const std::string unit = about.unit == "1" ? "no unit" : std::string(about.unit);
    measures.words.emplace_back(about.symbol, std::string(about.sentence) + " (" + unit + ")");
  }
  cli::Glossary flags{.title = "Flags", .words = {}};
  for (std::uint32_t bit = 0; bit < posturography::sway_flag::kCount; ++bit) {
    flags.words.emplace_back(posturography::names_of(1U << bit).front(), posturography::sentence_of(1U << bit));
  }
  return {std::move(measures), std::move(flags)};
}

}  // namespace

void add_commands(cli::CommandLine& line) {
  const auto [command, arguments] =
      add_command(line, line.app, "sway", "Measure the sway of a standing person: every measure of the centre of pressure",
                  "dtslab sway standing.csv | all measures in a table\n"
                  "dtslab sway standing.csv --profile asis --json | unfiltered, for a program\n"
                  "dtslab sway session.xdf | each trial of a recording, as dtsd measures it\n"
                  "dtslab sway sessions/ --table sway.csv | all recordings below a folder, one row per trial\n"
                  "dtslab sway open.csv closed.csv --label eyes=open,closed --compare | side by side, with Romberg quotients\n"
                  "dtslab sway session.xdf --trials 1,2 --compare | two trials of a recording\n"
                  "dtslab sway standing.c3d --plate 2 --ml +x --ap -y | one force plate of a file\n",
                  run_sway);
  command
      .add_option("FILE", arguments.inputs,
                  "CSV files with t_s,x_mm,y_mm, recordings of dtsd (.xdf, .xdf.part), files of force plates, folders of these")
      ->required()
      ->option_text("...");
  add_definition(command, arguments);
  command.add_option("--label", arguments.labels, "Add a label to the trials: one value for all files, or one value per file")
      ->option_text("NAME=VALUE[,VALUE...]")
      ->allow_extra_args(false);
  command.add_option("--trials", arguments.trials, "Numbers of the trials to measure, recordings only")
      ->option_text("N,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(cli::whole_number_between(1, 4294967295));
  command.add_flag("--all", arguments.is_all, "Also measure trials that were redone, rejected or aborted, recordings only");
  force::add_cop_choice(command, arguments.cop);
  command.add_flag("--compare", arguments.is_comparing, "Show two trials side by side");
  command.add_option("--table", arguments.table, "CSV file to write: one row per trial, all measures")
      ->option_text("OUT.csv")
      ->check(cli::text_of(1, 4096));
  add_json(command, arguments.is_json);
  line.glossaries[&command] = words_of_results();
}

}  // namespace dts::lab::sway
