// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "files/whole_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/steadiness/discriminant_evaluation.h"
#include "lab/steadiness/steadiness_commands.h"
#include "lab/steadiness/steadiness_model.h"
#include "lab/steadiness/steadiness_rows.h"

namespace dts::lab::steadiness {
namespace {

struct TrainArguments {
  std::string table;  ///< Written by `dtslab sway --table`.
  std::string label;  ///< The column to predict from measures.
  std::string out;
  std::vector<std::string> measures;
  bool is_json = false;
};

using posturography::Measure;

constexpr std::size_t kMostRows = 100'000;

bool is_in_every_row(Measure measure, const std::vector<SteadinessRow>& rows) {
  return std::ranges::all_of(rows, [&](const SteadinessRow& row) { return row.measures.has(measure); });
}

/// Returns the requested measures; without a request, the core measures that every row has.
core::Result<std::vector<Measure>> measures_of(const std::vector<std::string>& symbols, const std::vector<SteadinessRow>& rows) {
  std::vector<Measure> measures;
  for (const std::string& symbol : symbols) {
    const auto measure = posturography::measure_named(symbol);
    if (!measure)
      return core::fail(core::ErrorCode::InvalidArgument, "unknown measure '" + symbol + "'",
                        "write symbols such as MVELO,PEA95_F; dtslab sway --help lists them");
    const auto missing = std::ranges::find_if(rows, [&](const SteadinessRow& row) { return !row.measures.has(*measure); });
    if (missing != rows.end()) {
      return core::fail(core::ErrorCode::InvalidArgument, symbol + " is missing in line " + std::to_string(missing->line),
                        "choose another measure, or remove the row");
    }
    if (std::ranges::find(measures, *measure) == measures.end()) measures.push_back(*measure);
  }
  if (!symbols.empty()) return measures;
  for (std::size_t k = 0; k < posturography::kMeasureCount; ++k) {
    const auto measure = static_cast<Measure>(k);
    if (posturography::info(measure).is_core && is_in_every_row(measure, rows)) measures.push_back(measure);
  }
  if (!measures.empty()) return measures;
  return core::fail(core::ErrorCode::InvalidArgument, "no core measure is present in every row",
                    "choose measures with --measures, or use longer trials");
}

/// Returns the usable rows and reports the others.
std::vector<SteadinessRow> usable(std::vector<SteadinessRow> rows, const std::string& label, cli::Console& console) {
  const std::size_t invalid = std::erase_if(rows, [](const SteadinessRow& row) { return !row.is_valid; });
  const std::size_t nameless = std::erase_if(rows, [](const SteadinessRow& row) { return row.label.empty(); });
  const std::size_t empty = std::erase_if(rows, [](const SteadinessRow& row) { return row.measures.count() == 0; });
  if (invalid > 0) warn(console, std::to_string(invalid) + " rows left out: the subject stepped off or moved the feet");
  if (nameless > 0) warn(console, std::to_string(nameless) + " rows left out: empty cell in column '" + label + "'");
  if (empty > 0) warn(console, std::to_string(empty) + " rows left out: they have no measures");
  return rows;
}

core::Result<Samples> samples_of(const TrainArguments& arguments, const std::vector<SteadinessRow>& rows) {
  if (rows.empty()) return core::fail(core::ErrorCode::InvalidArgument, arguments.table + " has no usable row", "give another table");
  if (rows.size() > kMostRows) {
    return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostRows) + " rows", "use fewer rows");
  }
  DTS_TRY_ASSIGN(auto measures, measures_of(arguments.measures, rows));
  Samples samples{.measures = std::move(measures), .values = {}, .labels = {}, .subjects = {}};
  for (const SteadinessRow& row : rows) {
    samples.values.push_back(row.measures);
    samples.labels.push_back(row.label);
    samples.subjects.push_back(row.subject);
  }
  return samples;
}

cli::Json to_json(const Evaluation& evaluation, const SteadinessModel& model, const std::string& file) {
  cli::Json json{{"file", file}, {"label", model.label}, {"classes", evaluation.classes}, {"measures", cli::Json::array()}};
  for (const Predictor& predictor : model.discriminant.predictors)
    json["measures"].push_back(posturography::info(predictor.measure).symbol);
  json["rows"] = evaluation.rows;
  json["subjects"] = evaluation.subjects;
  json["rows_without_subject"] = evaluation.rows_without;
  json["correct"] = evaluation.correct;
  json["accuracy"] = evaluation.accuracy;
  json["balanced_accuracy"] = evaluation.balanced_accuracy;
  json["commonest_share"] = evaluation.commonest_share;
  json["interval_95"] = {evaluation.interval.low, evaluation.interval.high};
  json["interval_counts"] = evaluation.is_label_of_person ? "subjects" : "rows";
  json["confusion"] = evaluation.confusion;
  json["shrinkage"] = model.discriminant.shrinkage;
  json["is_better_than_chance"] = evaluation.is_better_than_chance();
  json["is_of_too_few_subjects"] = evaluation.is_of_too_few();
  return json;
}

std::string percent(double share) { return cli::decimal(100.0 * share, 1) + " %"; }

void print_confusion(const Evaluation& evaluation, cli::Console& console) {
  std::vector<std::string> headers{"TRUE \\ PREDICTED"};
  for (const std::string& name : evaluation.classes) headers.push_back(">" + cli::printable(name));
  headers.emplace_back(">no label");
  cli::Table table(headers);
  for (std::size_t k = 0; k < evaluation.classes.size(); ++k) {
    std::vector<cli::Cell> row{{evaluation.classes[k]}};
    for (std::size_t predicted = 0; predicted < evaluation.confusion[k].size(); ++predicted) {
      row.push_back({std::to_string(evaluation.confusion[k][predicted]), predicted == k ? cli::Style::Good : cli::Style::Plain});
    }
    table.add(std::move(row));
  }
  table.print(console);
}

/// Prints the conclusions that the figures allow, and their limits.
void print_conclusions(const Evaluation& evaluation, cli::Console& console) {
  const bool is_better = evaluation.is_better_than_chance();
  const std::string words = is_better ? "Better than always predicting the most frequent label."
                                      : "No better than chance: these measures do not predict these labels.";
  console.out << cli::styled(console, is_better ? cli::Style::Good : cli::Style::Warning, words) << '\n';
  if (evaluation.is_of_too_few()) {
    console.out << cli::styled(console, cli::Style::Warning,
                               "Only " + std::to_string(evaluation.subjects) + " subjects: too few for any claim about other people.")
                << '\n';
  }
  if (evaluation.rows_without > 0) {
    console.out
        << evaluation.rows_without
        << " rows have no subject ID and were left out one by one: if several rows are from one person, the results are too good.\n";
  }
}

void print_result(const Evaluation& evaluation, const SteadinessModel& model, const std::string& file, cli::Console& console) {
  const std::string counted = evaluation.is_label_of_person ? " (counting people: no person has two labels)" : " (counting rows)";
  cli::Table table({"TEST ON PEOPLE LEFT OUT", ">VALUE"});
  table.add({{"rows"}, {std::to_string(evaluation.rows)}});
  table.add({{"subjects"}, {std::to_string(evaluation.subjects)}});
  table.add({{"measures"}, {std::to_string(model.discriminant.predictors.size())}});
  table.add({{"correct"}, {percent(evaluation.accuracy)}});
  table.add({{"correct, 95 % interval" + counted}, {percent(evaluation.interval.low) + " .. " + percent(evaluation.interval.high)}});
  table.add({{"correct, mean over labels"}, {percent(evaluation.balanced_accuracy)}});
  table.add({{"correct if always the most frequent label"}, {percent(evaluation.commonest_share)}});
  table.print(console);
  console.out << '\n';
  print_confusion(evaluation, console);
  console.out << '\n';
  print_conclusions(evaluation, console);
  cli::print_hint(console, "to use it: dtslab steadiness classify " + file + " TABLE.csv");
}

/// Returns the rate of all rows; 0 if a row has none or another one.
double common_rate(const std::vector<SteadinessRow>& rows) {
  const double first_hz = rows.front().rate_hz;
  const bool is_common = std::ranges::all_of(rows, [&](const SteadinessRow& row) { return is_same_rate(row.rate_hz, first_hz); });
  return is_common ? first_hz : 0.0;
}

SteadinessModel model_of(const std::string& label, const std::vector<SteadinessRow>& rows, const Evaluation& evaluation,
                         Discriminant form) {
  std::set<std::string> profiles;
  for (const SteadinessRow& row : rows) profiles.insert(row.profile);
  return {.label = label,
          .profile = profiles.size() == 1 ? *profiles.begin() : std::string(),
          .rate_hz = common_rate(rows),
          .discriminant = std::move(form),
          .rows = evaluation.rows,
          .subjects = evaluation.subjects,
          .left_out_accuracy = evaluation.accuracy,
          .left_out_balanced_accuracy = evaluation.balanced_accuracy,
          .is_better_than_chance = evaluation.is_better_than_chance()};
}

int run_train(const TrainArguments& arguments, cli::Console& console) {
  if (const auto free = check_out(arguments.out, {arguments.table}); !free) return fail_with(console, free.error());
  if (force::is_force_file(arguments.table)) {
    return fail_with(console,
                     core::Error{core::ErrorCode::InvalidArgument, arguments.table + " is one trial on force plates, not a table",
                                 "make a table of all trials: dtslab sway FILES --label " + arguments.label + "=.. --table OUT.csv"});
  }
  files::Problems problems;
  auto read = read_rows(arguments.table, arguments.label, problems);
  if (!problems.empty()) return report_problems(console, problems);
  const std::vector<SteadinessRow> rows = usable(std::move(read), arguments.label, console);
  const auto samples = samples_of(arguments, rows);
  if (!samples) return fail_with(console, samples.error());
  const auto evaluation = [&] {
    cli::Progress progress(console, "leaving people out");
    return evaluate_left_out(*samples, [&](double part) { progress.report(part); });
  }();
  if (!evaluation) return fail_with(console, evaluation.error());
  std::vector<std::size_t> all(samples->labels.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  auto form = fit(*samples, all);
  if (!form) return fail_with(console, form.error());
  const SteadinessModel model = model_of(arguments.label, rows, *evaluation, std::move(*form));
  if (const auto written = files::write_whole_file(arguments.out, model_text(model)); !written) return fail_with(console, written.error());
  for (const std::string& difference : differences_of(rows)) warn(console, "the rows differ in " + difference + ": values depend on it");
  if (arguments.is_json) {
    console.out << cli::document(to_json(*evaluation, model, arguments.out));
  } else {
    print_result(*evaluation, model, arguments.out, console);
  }
  return cli::kOk;
}

}  // namespace

void add_train(cli::CommandLine& line, CLI::App& steadiness) {
  const auto [command, arguments] =
      add_command(line, steadiness, "train", "Train a linear discriminant and test it on people left out of the training",
                  "dtslab steadiness train sway.csv --label eyes --out eyes.json | with all core measures that every row has\n"
                  "dtslab steadiness train sway.csv --label group --measures MVELO,PEA95_F --out group.json | with two measures\n",
                  run_train);
  command.add_option("TABLE.csv", arguments.table, "Table from dtslab sway --table")->required()->option_text(" ");
  command.add_option("--label", arguments.label, "Column with the label to predict")->option_text("COLUMN")->required();
  command.add_option("--out", arguments.out, "File to write")->option_text("MODEL.json")->required();
  command
      .add_option("--measures", arguments.measures,
                  "Symbols of the measures, separated by commas. Default: the core measures that every row has")
      ->option_text("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
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
