// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "files/whole_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/base/small_file.h"
#include "lab/steadiness/steadiness_commands.h"
#include "lab/steadiness/steadiness_rows.h"
#include "lab/sway/sway_table.h"
#include "lab/sway/sway_view.h"
#include "pattern/decision.h"
#include "pattern/pattern_model.h"

namespace dts::lab::steadiness {
namespace {

using pattern::Answer;
using pattern::Outcome;
using pattern::PatternModel;
using sway::cell_text;

struct ClassifyArguments {
  std::string model;
  std::string table;     ///< Written by `dtslab sway --table`.
  std::string out;       ///< Empty: none.
  force::CopChoice cop;  ///< If `table` is a file of force plates.
  bool is_json = false;
};

/// A row and the model's answer.
struct Prediction {
  SteadinessRow row;
  pattern::Decision decision;
};

std::string outside_text(const Answer& answer, const std::string& separator) {
  std::string text;
  for (const auto measure : answer.outside) text += (text.empty() ? "" : separator) + std::string(posturography::info(measure).symbol);
  return text;
}

std::string csv_text(const std::vector<Prediction>& predictions, const PatternModel& model) {
  std::string text = "file,session,subject,trial,label";
  for (const std::string& name : model.discriminant.classes) text += "," + cell_text("p_" + name);
  text += ",outside,outcome\n";
  for (const auto& [row, decision] : predictions) {
    const Answer& answer = decision.answer;
    text += cell_text(row.file) + "," + cell_text(row.session) + "," + cell_text(row.subject) + "," + cell_text(row.trial) + ",";
    if (answer.best) text += cell_text(model.discriminant.classes[*answer.best]);
    for (std::size_t k = 0; k < model.discriminant.classes.size(); ++k) {
      text += "," + (answer.best ? sway::number_text(answer.probabilities[k]) : std::string());
    }
    text += "," + outside_text(answer, "|") + "," + std::string(name(decision.outcome)) + "\n";
  }
  return text;
}

cli::Json to_json(const Prediction& prediction, const PatternModel& model) {
  const auto& [row, decision] = prediction;
  const Answer& answer = decision.answer;
  cli::Json json{{"line", row.line}};
  if (!row.file.empty()) json["file"] = row.file;
  if (!row.session.empty()) json["session"] = row.session;
  if (!row.subject.empty()) json["subject"] = row.subject;
  if (!row.trial.empty()) json["trial"] = row.trial;
  if (answer.best) {
    json["label"] = model.discriminant.classes[*answer.best];
    for (std::size_t k = 0; k < answer.probabilities.size(); ++k)
      json["probabilities"][model.discriminant.classes[k]] = answer.probabilities[k];
  }
  json["outcome"] = name(decision.outcome);
  json["outside"] = cli::Json::array();
  for (const auto measure : answer.outside) json["outside"].push_back(posturography::info(measure).symbol);
  return json;
}

void print_predictions(const std::vector<Prediction>& predictions, const PatternModel& model, cli::Console& console) {
  cli::Table table({"FILE", "SUBJECT", "TRIAL", "LABEL", ">PROBABILITY", "OUTCOME", "OUTSIDE OF TRAINING"});
  for (const auto& [row, decision] : predictions) {
    const Answer& answer = decision.answer;
    table.add({{row.file},
               {row.subject},
               {row.trial},
               {answer.best ? model.discriminant.classes[*answer.best] : "-"},
               {answer.best ? cli::decimal(answer.probabilities[*answer.best], 3) : "-"},
               {std::string(name(decision.outcome)), decision.outcome == Outcome::Decided ? cli::Style::Plain : cli::Style::Warning},
               {outside_text(answer, " "), cli::Style::Warning}});
  }
  table.print(console);
}

void show(const std::vector<Prediction>& predictions, const PatternModel& model, const ClassifyArguments& arguments,
          cli::Console& console) {
  if (arguments.is_json) {
    cli::Json json{{"model", arguments.model}, {"told", model.label}, {"predictions", cli::Json::array()}};
    json["condition"] = model.condition;
    json["verdict"] = verdict_text(model);
    for (const Prediction& prediction : predictions) json["predictions"].push_back(to_json(prediction, model));
    console.out << cli::document(json);
    return;
  }
  if (arguments.out.empty()) return print_predictions(predictions, model, console);
  console.out << arguments.out << ": " << predictions.size() << " rows\n";
}

/// Prints reasons to doubt the answers.
void print_doubts(const std::vector<Prediction>& predictions, const PatternModel& model, cli::Console& console) {
  std::size_t silent = 0;
  std::size_t outside = 0;
  std::size_t invalid = 0;
  std::size_t differing = 0;
  std::size_t slower_or_faster = 0;
  std::size_t longer_or_shorter = 0;
  for (const auto& [row, decision] : predictions) {
    const Answer& answer = decision.answer;
    if (!answer.best) ++silent;
    if (!answer.outside.empty()) ++outside;
    if (!row.is_valid) ++invalid;
    if (!row.profile.empty() && !model.profile.empty() && row.profile != model.profile) ++differing;
    if (row.rate_hz > 0.0 && model.rate_hz > 0.0 && !pattern::is_alike(row.rate_hz, model.rate_hz)) ++slower_or_faster;
    if (row.duration_s > 0.0 && model.duration_s > 0.0 && !pattern::is_alike(row.duration_s, model.duration_s)) ++longer_or_shorter;
  }
  const auto say = [&](std::size_t count, const std::string& text) {
    if (count > 0) warn(console, std::to_string(count) + " of " + std::to_string(predictions.size()) + " rows " + text);
  };
  if (model.verdict != pattern::Verdict::Told)
    warn(console, "this model is for research only: its label is " + verdict_text(model) + " in people left out of the training");
  say(silent, "have no label: a measure that the model needs is missing or not above 0");
  say(outside, "are outside the range of the training: their labels are guesses");
  say(invalid, "are from subjects who stepped off or moved the feet");
  say(differing, "were measured with another profile than '" + model.profile + "', with which the model was trained");
  say(slower_or_faster,
      "were analysed at another rate than " + sway::significant(model.rate_hz, 4) + " Hz, at which the model was trained");
  say(longer_or_shorter,
      "are longer or shorter than " + sway::significant(model.duration_s, 4) + " s, the duration of the trials of the training");
}

int run_classify(const ClassifyArguments& arguments, cli::Console& console) {
  if (!arguments.out.empty()) {
    if (const auto free = check_out(arguments.out, {arguments.table, arguments.model}); !free) return fail_with(console, free.error());
  }
  const auto text = read_small_file(arguments.model);
  if (!text) return fail_with(console, text.error());
  const auto model = pattern::read_model_text(*text, arguments.model);
  if (!model) return fail_with(console, model.error());
  files::Problems problems;
  std::vector<SteadinessRow> rows;
  if (force::has_plates(arguments.table, arguments.cop)) {
    auto row = row_of_plates(arguments.table, arguments.cop, model->profile, model->rate_hz);
    if (!row) return fail_with(console, row.error());
    rows.push_back(std::move(*row));
  } else {
    rows = read_rows(arguments.table, {}, {}, problems);
  }
  if (!problems.empty()) return report_problems(console, problems);
  std::vector<Prediction> predictions;
  for (SteadinessRow& row : rows) {
    pattern::Decision decision = decide(
        *model,
        {.measures = row.measures, .profile = row.profile, .rate_hz = row.rate_hz, .duration_s = row.duration_s, .is_valid = row.is_valid});
    predictions.push_back({std::move(row), std::move(decision)});
  }
  if (!arguments.out.empty()) {
    if (const auto written = files::write_whole_file(arguments.out, csv_text(predictions, *model)); !written) {
      return fail_with(console, written.error());
    }
  }
  show(predictions, *model, arguments, console);
  print_doubts(predictions, *model, console);
  return cli::kOk;
}

}  // namespace

void add_classify(cli::CommandLine& line, CLI::App& steadiness) {
  const auto [command, arguments] = add_command(line, steadiness, "classify", "Predict the label of each row of a table",
                                                "dtslab steadiness classify eyes.json new.csv | a table\n"
                                                "dtslab steadiness classify eyes.json new.csv --out pred.csv | write a file\n"
                                                "dtslab steadiness classify eyes.json new.c3d --ml +x --ap -y | a force plate\n",
                                                run_classify);
  command.add_option("MODEL.json", arguments.model, "Made by dtslab steadiness train")->required()->option_text(" ");
  command
      .add_option("TABLE.csv", arguments.table, "Table from dtslab sway --table, with the same profile and rate; or a file of force plates")
      ->required()
      ->option_text(" ");
  force::add_cop_choice(command, arguments.cop);
  command.add_option("--out", arguments.out, "File to write")->option_text("PRED.csv");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::steadiness
