// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/exit_status.h"
#include "cli/progress.h"
#include "files/whole_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/steadiness/discriminant_evaluation.h"
#include "lab/steadiness/steadiness_commands.h"
#include "lab/steadiness/train_input.h"
#include "lab/steadiness/train_view.h"
#include "pattern/decision.h"

namespace dts::lab::steadiness {
namespace {

using pattern::PatternModel;

/// Returns the rate or duration of all rows; 0 if a row has none or another one.
double common(const std::vector<SteadinessRow>& rows, double SteadinessRow::*member) {
  const double first = rows.front().*member;
  const bool is_common = std::ranges::all_of(rows, [&](const SteadinessRow& row) { return pattern::is_alike(row.*member, first); });
  return is_common ? first : 0.0;
}

std::vector<pattern::Group> groups_of(const TrainInput& input, const Evaluation& evaluation) {
  std::vector<pattern::Group> groups(evaluation.classes.size());
  for (std::size_t k = 0; k < groups.size(); ++k) {
    std::set<std::size_t> people;
    for (std::size_t row = 0; row < input.rows.size(); ++row) {
      if (input.rows[row].label != evaluation.classes[k]) continue;
      ++groups[k].trials;
      people.insert(evaluation.people.of_row[row]);
    }
    groups[k].people = people.size();
    if (const auto moved = input.moved.find(evaluation.classes[k]); moved != input.moved.end()) groups[k].moved = moved->second;
  }
  return groups;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : " ") + part;
  return text;
}

PatternModel model_of(const TrainArguments& arguments, const TrainInput& input, const Evaluation& evaluation,
                      pattern::Discriminant discriminant) {
  std::set<std::string> profiles;
  for (const SteadinessRow& row : input.rows) profiles.insert(row.profile);
  return {.label = arguments.label,
          .condition = joined(arguments.where),
          .about = arguments.about,
          .profile = profiles.size() == 1 ? *profiles.begin() : std::string(),
          .rate_hz = common(input.rows, &SteadinessRow::rate_hz),
          .duration_s = common(input.rows, &SteadinessRow::duration_s),
          .noise_mm = arguments.noise_mm,
          .discriminant = std::move(discriminant),
          .rows = evaluation.rows,
          .people = evaluation.people.count,
          .groups = groups_of(input, evaluation),
          .verdict = evaluation.verdict,
          .told_by = evaluation.told_by,
          .figures = figures_of(evaluation)};
}

core::Status check_arguments(const TrainArguments& arguments) {
  if (!arguments.out.empty()) DTS_TRY(check_out(arguments.out, {arguments.table}));
  if (arguments.noise_hz > 0.0 && arguments.noise_mm == 0.0)
    return core::fail(core::ErrorCode::InvalidArgument, "--noise-rate needs --noise-mm", "state the noise of one scan with --noise-mm");
  if (!force::is_force_file(arguments.table)) return {};
  return core::fail(core::ErrorCode::InvalidArgument, arguments.table + " is one trial on force plates, not a table",
                    "make a table of all trials: dtslab sway FILES --label " + arguments.label + "=.. --table OUT.csv");
}

/// Writes the model if it was asked for and its label is distinguished, or if it is for research. Returns whether the request is met.
core::Result<bool> write_model(const TrainArguments& arguments, const PatternModel& model) {
  if (arguments.out.empty()) return true;
  if (model.verdict != Verdict::Told && !arguments.is_research) return false;
  DTS_TRY(files::write_whole_file(arguments.out, pattern::model_text(model)));
  return true;
}

int run_train(const TrainArguments& arguments, cli::Console& console) {
  if (const auto checked = check_arguments(arguments); !checked) return fail_with(console, checked.error());
  files::Problems problems;
  const auto input = read_train_input(arguments, console, problems);
  if (!problems.empty()) return report_problems(console, problems);
  if (!input) return fail_with(console, input.error());
  const auto evaluation = [&] {
    cli::Progress progress(console, "random labels");
    return evaluate_left_out(input->samples, input->rivals, [&](double part) { progress.report(part); });
  }();
  if (!evaluation) return fail_with(console, evaluation.error());
  auto discriminant = fit_all(input->samples);
  if (!discriminant) return fail_with(console, discriminant.error());
  const PatternModel model = model_of(arguments, *input, *evaluation, std::move(*discriminant));
  const auto written = write_model(arguments, model);
  if (!written) return fail_with(console, written.error());
  for (const std::string& difference : differences_of(input->rows))
    warn(console, "the rows differ in " + difference + ": values depend on it");
  if (arguments.is_json) {
    console.out << cli::document(to_json(*evaluation, model, *written ? arguments.out : std::string()));
  } else {
    print_result(*evaluation, model, console);
  }
  if (!*written) {
    return fail_with(
        console, core::Error{core::ErrorCode::Failed, arguments.out + " was not written: " + arguments.label + " is " + verdict_text(model),
                             "do not use such a model; to study it, add --research"});
  }
  if (!arguments.out.empty() && !arguments.is_json)
    cli::print_hint(console, "to use it: dtslab steadiness classify " + arguments.out + " TABLE.csv");
  return cli::kOk;
}

}  // namespace

void add_train(cli::CommandLine& line, CLI::App& steadiness) {
  const auto [command, arguments] =
      add_command(line, steadiness, "train", "Train a linear discriminant and test it on people left out of the training",
                  "dtslab steadiness train sway.csv --label eyes --out eyes.json | with all core measures that every row has\n"
                  "dtslab steadiness train sway.csv --label fell --where condition=ec_firm --against age,sex | only the test\n"
                  "dtslab steadiness train sway.csv --label group --measures MVELO,PEA95_F --out group.json | with two measures\n",
                  run_train);
  command.add_option("TABLE.csv", arguments.table, "Table from dtslab sway --table")->required()->option_text(" ");
  command.add_option("--label", arguments.label, "Column with the label to predict")->option_text("COLUMN")->required();
  command.add_option("--out", arguments.out, "File to write; not written if the label is not told")->option_text("MODEL.json");
  command.add_option("--where", arguments.where, "Only rows with this value, or one of these, in this column. Repeat it for more columns")
      ->option_text("COLUMN=VALUE[,VALUE]")
      ->allow_extra_args(false);
  command
      .add_option("--against", arguments.against,
                  "Facts that might predict the label as well. Default: those of age,height_cm,sex in the table. The verdict needs age")
      ->option_text("COLUMN,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      .add_option("--measures", arguments.measures,
                  "Symbols of the measures, separated by commas. Default: the core measures that every row has")
      ->option_text("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      .add_option("--noise-mm", arguments.noise_mm,
                  "Add the noise of the rig where the model will be used: SD of the COP of one scan, in each axis (mm)")
      ->option_text("MM")
      ->check(CLI::Range(0.0, 100.0));
  command.add_option("--noise-rate", arguments.noise_hz, "Scan rate of that rig (Hz). Default: the rate of the table")
      ->option_text("HZ")
      ->check(CLI::Range(1.0, 20000.0));
  command.add_option("--about", arguments.about, "What a reader must know about the people; shown with every decision")
      ->option_text("TEXT")
      ->check(CLI::Validator(
          [](const std::string& text) { return text.size() <= 500 ? std::string() : std::string("longer than 500 characters"); }, ""));
  command.add_flag("--research", arguments.is_research, "Write the model even if the label is not told; no rig accepts it");
  add_json(command, arguments.is_json);
}

void add_commands(cli::CommandLine& line) {
  CLI::App* steadiness =
      cli::add_group(line.app, "steadiness", "Classify conditions or groups of people by their sway",
                     "dtslab steadiness train sway.csv --label eyes --out eyes.json | train, and show how well it works\n"
                     "dtslab steadiness classify eyes.json new.csv | classify new trials\n");
  add_train(line, *steadiness);
  add_classify(line, *steadiness);
}

}  // namespace dts::lab::steadiness
