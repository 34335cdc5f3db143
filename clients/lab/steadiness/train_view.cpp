// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/train_view.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "cli/table.h"

namespace dts::lab::steadiness {
namespace {

using pattern::PatternModel;

std::string signed_number(double value) { return (value < 0.0 ? "" : "+") + cli::decimal(value, 2); }

std::string auc_text(const Interval& interval) {
  return cli::decimal(interval.value, 2) + " (" + cli::decimal(interval.low, 2) + ".." + cli::decimal(interval.high, 2) + ")";
}

std::string gain_text(const Interval& gain) {
  return signed_number(gain.value) + " (" + signed_number(gain.low) + ".." + signed_number(gain.high) + ")";
}

std::string percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? std::string("-") : cli::decimal(100.0 * static_cast<double>(part) / static_cast<double>(whole), 1) + " %";
}

std::vector<cli::Cell> contest_row(const std::string& name, const Contest& contest, const std::string& gain, const std::string& base) {
  return {{name},
          {auc_text(contest.auc)},
          {gain},
          {cli::decimal(contest.auc_trials, 2)},
          {cli::decimal(contest.equal_error_correct, 2)},
          {cli::decimal(contest.brier, 2) + base},
          {contest.slope ? cli::decimal(*contest.slope, 2) : "-"}};
}

void print_test(const LeftOutTest& test, const Evaluation& evaluation, double noise_mm, cli::Console& console) {
  const std::string who =
      std::to_string(evaluation.people.count) + " people, " + std::to_string(evaluation.rows) + " trials, " + test.scheme;
  const std::string noise = noise_mm > 0.0 ? ", noise of " + cli::decimal(noise_mm, 2) + " mm added" : "";
  cli::Table table({"TOLD OF PEOPLE LEFT OUT (" + who + noise + ")", ">AUC people (95 %)", ">this model minus it (95 %)", ">AUC trials",
                    ">right at equal err.", ">Brier (base)", ">slope"});
  table.add(contest_row("this model, " + test.model.name, test.model, "-", " (" + cli::decimal(evaluation.brier_base, 2) + ")"));
  const std::string chosen = " in " + std::to_string(test.best_chosen_by) + " of " + std::to_string(test.folds);
  table.add(contest_row("best measure alone (" + test.best_measure + chosen + ")", test.best, gain_text(test.best.gain), ""));
  for (const Contest& rival : test.rivals) table.add(contest_row(rival.name + ", without a plate", rival, gain_text(rival.gain), ""));
  table.add({{"always the commonest"}, {"0.50"}, {"-"}, {"-"}, {"0.50"}, {cli::decimal(evaluation.brier_base, 2)}, {"-"}});
  table.print(console);
  console.out << '\n';
}

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
  console.out << '\n';
}

void print_groups(const PatternModel& model, cli::Console& console) {
  cli::Table table({"GROUP", ">people", ">trials", ">not valid (stepped off, moved the feet)", ">share"});
  for (std::size_t k = 0; k < model.groups.size(); ++k) {
    const pattern::Group& group = model.groups[k];
    table.add({{model.discriminant.classes[k]},
               {std::to_string(group.people)},
               {std::to_string(group.trials)},
               {std::to_string(group.moved)},
               {percent(group.moved, group.trials + group.moved)}});
  }
  table.print(console);
  console.out << '\n';
}

/// Returns why the label is not told.
std::string reason_of(const Evaluation& evaluation) {
  if (evaluation.verdict == Verdict::ToldByOther) return "the AUC of " + evaluation.told_by + " alone is clearly larger";
  if (evaluation.is_of_too_few())
    return "only " + std::to_string(evaluation.people.named) + " subjects: too few for any claim about other people";
  if (!(evaluation.deciding().model.auc.low > 0.5)) return "the interval of the AUC of people reaches 0.5";
  if (!(evaluation.permutation_p <= Evaluation::kMostP))
    return "random labels of the people are predicted as well (p = " + cli::decimal(evaluation.permutation_p, 3) +
           ", must be 0.01 or less)";
  return "it was not compared with the people's age: the table needs the column 'age', and --against must not leave it out";
}

/// Prints the conclusions that the figures allow, and their limits.
void print_conclusions(const Evaluation& evaluation, const PatternModel& model, cli::Console& console) {
  const auto say = [&](cli::Style style, const std::string& text) { console.out << cli::styled(console, style, text) << '\n'; };
  const bool is_told = evaluation.verdict == Verdict::Told;
  const std::string p = "permutation p = " + cli::decimal(evaluation.permutation_p, 3);
  if (is_told) {
    say(cli::Style::Good, model.label + ": told (" + p + ")");
  } else {
    say(cli::Style::Warning, model.label + ": " + verdict_text(model) + ": " + reason_of(evaluation) + " (" + p + ")");
  }
  if (!evaluation.is_better_than_one_measure()) {
    say(cli::Style::Plain, "No better than one measure: " + evaluation.deciding().best_measure + ".");
  } else if (is_told) {
    say(cli::Style::Plain, "Better than one measure.");
  }
  if (const std::string& rival = model.figures.rival; !rival.empty() && is_told && !(model.figures.rival_gain.low > 0.0))
    say(cli::Style::Plain, "Without a plate, " + rival + " does as well.");
  for (const std::string& fact : evaluation.definitions)
    say(cli::Style::Plain, "'" + fact + "' gives every label without error: it defines the label, and is not compared.");
  if (evaluation.rows_without > 0) {
    say(cli::Style::Warning,
        std::to_string(evaluation.rows_without) +
            " rows have no subject ID and were left out one by one: if several rows are from one person, the results are "
            "too good.");
  }
}

cli::Json interval_json(const Interval& interval) { return cli::Json::array({interval.value, interval.low, interval.high}); }

cli::Json contest_json(const Contest& contest) {
  cli::Json json{{"name", contest.name},
                 {"auc_people", contest.auc.value},
                 {"auc_people_95", {contest.auc.low, contest.auc.high}},
                 {"auc_trials", contest.auc_trials},
                 {"equal_error_correct", contest.equal_error_correct},
                 {"brier", contest.brier}};
  if (contest.slope) json["slope"] = *contest.slope;
  return json;
}

cli::Json test_json(const LeftOutTest& test) {
  cli::Json json{{"scheme", test.scheme}, {"model", contest_json(test.model)}, {"best_measure", contest_json(test.best)}};
  json["best_measure"]["chosen_by"] = {test.best_chosen_by, test.folds};
  json["best_measure"]["model_minus_this"] = interval_json(test.best.gain);
  json["rivals"] = cli::Json::array();
  for (const Contest& rival : test.rivals) {
    json["rivals"].push_back(contest_json(rival));
    json["rivals"].back()["model_minus_this"] = interval_json(rival.gain);
  }
  return json;
}

}  // namespace

cli::Json to_json(const Evaluation& evaluation, const PatternModel& model, const std::string& file) {
  cli::Json json;
  if (!file.empty()) json["file"] = file;
  json["label"] = model.label;
  json["condition"] = model.condition;
  json["verdict"] = verdict_text(model);
  json["is_told"] = evaluation.verdict == Verdict::Told;
  if (evaluation.verdict != Verdict::Told) json["reason"] = reason_of(evaluation);
  json["is_better_than_one_measure"] = evaluation.is_better_than_one_measure();
  json["permutation_p"] = evaluation.permutation_p;
  json["noise_mm"] = model.noise_mm;
  json["tests"] = cli::Json::array({test_json(evaluation.left_out)});
  if (evaluation.ten_fold) json["tests"].push_back(test_json(*evaluation.ten_fold));
  json["defined_by"] = evaluation.definitions;
  json["classes"] = evaluation.classes;
  json["groups"] = cli::Json::array();
  for (const pattern::Group& group : model.groups)
    json["groups"].push_back({{"people", group.people}, {"trials", group.trials}, {"not_valid", group.moved}});
  json["measures"] = cli::Json::array();
  for (const pattern::Predictor& predictor : model.discriminant.predictors)
    json["measures"].push_back(posturography::info(predictor.measure).symbol);
  json["rows"] = evaluation.rows;
  json["subjects"] = evaluation.people.named;
  json["rows_without_subject"] = evaluation.rows_without;
  json["correct"] = evaluation.correct;
  json["accuracy"] = evaluation.accuracy;
  json["balanced_accuracy"] = evaluation.balanced_accuracy;
  json["commonest_share"] = evaluation.commonest_share;
  json["brier_base"] = evaluation.brier_base;
  json["confusion"] = evaluation.confusion;
  json["shrinkage"] = model.discriminant.shrinkage;
  json["is_of_too_few_subjects"] = evaluation.is_of_too_few();
  return json;
}

void print_result(const Evaluation& evaluation, const PatternModel& model, cli::Console& console) {
  print_test(evaluation.left_out, evaluation, model.noise_mm, console);
  if (evaluation.ten_fold) print_test(*evaluation.ten_fold, evaluation, model.noise_mm, console);
  print_confusion(evaluation, console);
  print_groups(model, console);
  print_conclusions(evaluation, model, console);
}

}  // namespace dts::lab::steadiness
