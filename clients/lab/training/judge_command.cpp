// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "files/trunk_model_file.h"
#include "lab/base/command.h"
#include "lab/base/plot.h"
#include "lab/base/problems.h"
#include "lab/training/model_judgement.h"
#include "lab/training/training_commands.h"

namespace dts::lab::training {
namespace {

struct JudgeArguments {
  std::string model;
  JudgementOptions options;
  std::uint32_t seed = 1;
  std::string plot;  ///< Output file for a picture; empty: none.
  bool is_json = false;
};

struct ReasonName {
  std::uint16_t reason;
  const char* key;
  const char* text;
};

constexpr ReasonName kReasonNames[] = {
    {0, "not_found", "no reach was found"},
    {core::class_reason::kUnsure, "unsure", "probability below the limit"},
    {core::class_reason::kBadReach, "bad_reach", "doubtful reach, for example a sensor at the end of its range"},
    {core::class_reason::kOutOfRange, "out_of_range", "outside the training data"},
    {core::class_reason::kDisagreement, "disagreement", "class and angle disagree"},
};

const ReasonName& name_of_reason(std::uint16_t reason) {
  for (const ReasonName& name : kReasonNames) {
    if (name.reason == reason) return name;
  }
  return kReasonNames[0];
}

double part_of_count(std::size_t part, std::size_t all) { return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all); }

cli::Json answers_json(const Answers& answers, std::size_t reaches) {
  return {{"kept", part_of_count(answers.kept, reaches)},
          {"kept_accuracy", part_of_count(answers.right, answers.kept)},
          {"kept_accuracy_by_target", part_of_count(answers.by_target, answers.kept)}};
}

cli::Json judgement_json(const Judgement& judgement) {
  cli::Json json{{"is_synthetic", true},
                 {"seed", judgement.options.seed},
                 {"people", judgement.options.people},
                 {"spread", judgement.options.between_people},
                 {"reaches", judgement.reaches},
                 {"accuracy", part_of_count(judgement.guessed_right, judgement.reaches)},
                 {"own_accuracy", part_of_count(judgement.own_guessed_right, judgement.reaches)},
                 {"general", answers_json(judgement.general, judgement.reaches)},
                 {"own", answers_json(judgement.own, judgement.reaches)},
                 {"rejections", cli::Json::array()},
                 {"curve", cli::Json::array()}};
  for (const JudgedReason& reason : judgement.reasons) {
    json["rejections"].push_back(
        {{"reason", name_of_reason(reason.reason).key}, {"reaches", reason.rejected}, {"right_without", reason.right}});
  }
  for (const JudgedLimit& limit : judgement.curve) {
    json["curve"].push_back({{"limit", limit.reject_below},
                             {"general", answers_json(limit.general, judgement.reaches)},
                             {"own", answers_json(limit.own, judgement.reaches)}});
  }
  return json;
}

std::string three(std::size_t part, std::size_t all) { return cli::decimal(part_of_count(part, all), 3); }

void print_judgement(const Judgement& judgement, cli::Console& console) {
  const std::size_t all = judgement.reaches;
  cli::Table table({"ANSWERS", ">GENERAL", ">OWN SCALE"});
  table.add({{"correct, nothing rejected"}, {three(judgement.guessed_right, all)}, {three(judgement.own_guessed_right, all)}});
  table.add({{"answered"}, {three(judgement.general.kept, all)}, {three(judgement.own.kept, all)}});
  table.add({{"correct of the answered"},
             {three(judgement.general.right, judgement.general.kept)},
             {three(judgement.own.right, judgement.own.kept)}});
  table.add({{"... if class 0 is never right"},
             {three(judgement.general.by_target, judgement.general.kept)},
             {three(judgement.own.by_target, judgement.own.kept)}});
  table.print(console);
  console.out << '\n';
  cli::Table reasons({"REJECTED BECAUSE", ">REACHES", ">CORRECT IF ANSWERED"});
  for (const JudgedReason& reason : judgement.reasons) {
    reasons.add({{name_of_reason(reason.reason).text}, {std::to_string(reason.rejected)}, {std::to_string(reason.right)}});
  }
  reasons.print(console);
  console.out << '\n';
  cli::Table curve({">LIMIT", ">ANSWERED", ">CORRECT OF THESE", ">OWN SCALE: ANSWERED", ">CORRECT OF THESE "});
  for (const JudgedLimit& limit : judgement.curve) {
    curve.add({{cli::decimal(limit.reject_below, 2)},
               {three(limit.general.kept, all)},
               {three(limit.general.right, limit.general.kept)},
               {three(limit.own.kept, all)},
               {three(limit.own.right, limit.own.kept)}});
  }
  curve.print(console);
  console.out << "\nAll people are simulated. " << all << " reaches to 120 %, 150 % and the maximum.\n"
              << "Correct: the class of the target, or class 0 if the trunk in fact stayed at the back rest.\n";
}

core::Status draw_judgement(const Judgement& judgement, const std::string& file) {
  Curve general{.name = "general", .points = {}};
  Curve own{.name = "own scale", .points = {}};
  for (const JudgedLimit& limit : judgement.curve) {
    general.points.emplace_back(part_of_count(limit.general.kept, judgement.reaches),
                                1.0 - part_of_count(limit.general.right, limit.general.kept));
    own.points.emplace_back(part_of_count(limit.own.kept, judgement.reaches), 1.0 - part_of_count(limit.own.right, limit.own.kept));
  }
  return draw_curves({.title = "Wrong answers over the part that is answered, simulated people",
                      .x_label = "answered part",
                      .y_label = "wrong of the answered",
                      .curves = {general, own}},
                     file);
}

int run_reach_judge(const JudgeArguments& arguments, cli::Console& console) {
  if (!arguments.plot.empty()) {
    if (const auto name = check_plot_name(arguments.plot); !name) return fail_with(console, name.error());
  }
  files::Problems problems;
  const auto model = files::load_trunk_model(arguments.model, problems);
  if (!problems.empty() || !model) return report_problems(console, problems);
  JudgementOptions options = arguments.options;
  options.seed = arguments.seed;
  core::Result<Judgement> judgement;
  {
    cli::Progress progress(console, "simulating people");
    judgement = judge_model(*model, options, [&progress](double done) { progress.report(done); });
  }
  if (!judgement) return fail_with(console, judgement.error());
  if (!arguments.plot.empty()) {
    if (const auto drawn = draw_judgement(*judgement, arguments.plot); !drawn) return fail_with(console, drawn.error());
  }
  if (arguments.is_json) {
    console.out << cli::document(judgement_json(*judgement));
  } else {
    print_judgement(*judgement, console);
  }
  return cli::kOk;
}

}  // namespace

void add_judge(cli::CommandLine& line, CLI::App& reach) {
  const auto [command, arguments] =
      add_command(line, reach, "judge", "Count the rejected and the wrong answers of a model on simulated people",
                  "dtslab reach judge model.toml | sixty people who are not those of the training\n"
                  "dtslab reach judge model.toml --spread 1.5 | people who differ more than those of the training\n"
                  "dtslab reach judge model.toml --plot curve.svg | draw the errors over the answered part\n",
                  run_reach_judge);
  command.add_option("MODEL", arguments.model, "Made by dtslab reach train")->required()->option_text(" ");
  command.add_option("--people", arguments.options.people, "Number of people. Default: 60")->option_text("N");
  command.add_option("--trials", arguments.options.trials, "Reaches of each person to each target. Default: 10")->option_text("N");
  command.add_option("--spread", arguments.options.between_people, "How much people differ, 0 to 2; training: 1. Default: 1")
      ->option_text("X");
  add_seed(command, arguments.seed, "Another seed gives other people; no seed gives those of the training");
  add_plot(command, arguments.plot, "Draw the errors over the answered part");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::training
