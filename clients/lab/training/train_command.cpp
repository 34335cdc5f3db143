// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <utility>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "files/trunk_model_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/reach/events_command.h"
#include "lab/reach/trial_set.h"
#include "lab/training/gather.h"
#include "lab/training/model_training.h"
#include "lab/training/simulated_people.h"
#include "lab/training/training_commands.h"

namespace dts::lab::training {
namespace {

struct TrainArguments {
  std::string folder;  ///< Empty: none.
  std::string out;
  std::string net = "recommended";    ///< Or "raw5".
  std::vector<std::string> subjects;  ///< To train on; empty: all healthy ones.
  std::uint32_t seed = 1;
  bool has_simulated_people = false;  ///< Train also, or only, on simulated people.
  bool is_recorded_only = false;      ///< Train without simulated people.
  bool is_json = false;
};

using classifier::ModelFigures;
using classifier::TrunkModelForm;

struct Figure {
  const char* key;
  const char* text;
  double ModelFigures::*member;
};

constexpr Figure kFigures[] = {
    {"validation_accuracy", "correct, same people", &ModelFigures::validation_accuracy},
    {"left_out_accuracy", "correct, people left out", &ModelFigures::left_out_accuracy},
    {"left_out_own_accuracy", "correct with personal scale, left out", &ModelFigures::left_out_own_accuracy},
    {"left_out_kept", "answered, left out", &ModelFigures::left_out_kept},
    {"left_out_kept_accuracy", "correct of the answered, left out", &ModelFigures::left_out_kept_accuracy},
    {"left_out_angle_rms_deg", "trunk angle, rms error (deg), left out", &ModelFigures::left_out_angle_rms_deg},
    {"left_out_angle_coverage", "90 % intervals with the true angle, left out", &ModelFigures::left_out_angle_coverage},
    {"expected_calibration_error", "error of the probabilities, left out", &ModelFigures::expected_calibration_error},
};

cli::Json to_json(const TrunkModelForm& form, const std::string& file) {
  cli::Json json{{"file", file},
                 {"kind", form.kind == classifier::ModelKind::Raw5 ? "raw5" : "recommended"},
                 {"networks", form.general.networks.size()},
                 {"subjects", form.facts.subjects},
                 {"simulated_subjects", form.facts.simulated_subjects},
                 {"trials", form.facts.trials},
                 {"seed", form.facts.seed},
                 {"data_sha256", form.facts.data_sha256}};
  json["figures"] = cli::Json::object();
  for (const Figure& figure : kFigures) cli::set_number(json["figures"], figure.key, form.figures.*figure.member);
  return json;
}

void print_model(const TrunkModelForm& form, const TrainArguments& arguments, cli::Console& console) {
  if (arguments.is_json) {
    console.out << cli::document(to_json(form, arguments.out));
    return;
  }
  cli::Table table({"FIGURE", ">VALUE"});
  table.add({{"reaches"}, {std::to_string(form.facts.trials)}});
  table.add({{"people"}, {std::to_string(form.facts.subjects.size())}});
  if (form.facts.simulated_subjects > 0) table.add({{"simulated people"}, {std::to_string(form.facts.simulated_subjects)}});
  for (const Figure& figure : kFigures) {
    const double value = form.figures.*figure.member;
    if (std::isfinite(value)) table.add({{figure.text}, {cli::decimal(value, 3)}});
  }
  table.print(console);
  cli::print_hint(console, "to use it: dtslab reach classify " + arguments.out + " DIR --out PRED.csv");
}

// Large enough: another draw of the same size changes the left-out figures by less than their own spread.
constexpr std::size_t kSimulatedPeople = 160;
constexpr int kSimulatedTrials = 6;  ///< Per target.

core::Result<TrainingSet> recorded(const TrainArguments& arguments, files::Problems& problems, cli::Console& console) {
  const auto set = reach::read_trial_set(arguments.folder, problems);
  if (!problems.empty()) return TrainingSet{};
  cli::Progress progress(console, "finding reaches");
  return gather(set, reach::find_reaches(set, [&](double part) { progress.report(part); }), arguments.subjects);
}

/// Returns whether to use simulated people. The recommended model also learns from them, because four recorded people do not show how
/// people differ.
bool is_simulating(const TrainArguments& arguments) {
  return arguments.has_simulated_people || (arguments.net != "raw5" && !arguments.is_recorded_only);
}

core::Result<TrainingSet> training_set(const TrainArguments& arguments, files::Problems& problems, cli::Console& console) {
  if (arguments.folder.empty() && !arguments.has_simulated_people) {
    return core::fail(core::ErrorCode::InvalidArgument, "no trials to train on", "give a folder of trials, or --simulated");
  }
  core::Result<TrainingSet> set = arguments.folder.empty() ? TrainingSet{} : recorded(arguments, problems, console);
  if (!set || !problems.empty() || !is_simulating(arguments)) return set;
  cli::Progress progress(console, "simulating people");
  DTS_TRY_ASSIGN(const auto simulated,
                 simulated_people(kSimulatedPeople, kSimulatedTrials, arguments.seed, [&](double part) { progress.report(part); }));
  return joined(std::move(*set), simulated);
}

int run_reach_train(const TrainArguments& arguments, cli::Console& console) {
  if (const auto free = check_out(arguments.out, {arguments.folder}); !free) return fail_with(console, free.error());
  files::Problems problems;
  const auto set = training_set(arguments, problems, console);
  if (!problems.empty()) return report_problems(console, problems);
  if (!set) return fail_with(console, set.error());
  const ModelOptions options{.kind = arguments.net == "raw5" ? classifier::ModelKind::Raw5 : classifier::ModelKind::Recommended,
                             .seed = arguments.seed};
  core::Result<classifier::TrunkModel> model = [&] {
    cli::Progress progress(console, "training");
    return train_model(*set, options, [&](double part) { progress.report(part); });
  }();
  if (!model) return fail_with(console, model.error());
  if (const auto saved = files::save_trunk_model(arguments.out, *model); !saved) return fail_with(console, saved.error());
  print_model(model->form(), arguments, console);
  return cli::kOk;
}

}  // namespace

void add_train(cli::CommandLine& line, CLI::App& reach) {
  const auto [command, arguments] =
      add_command(line, reach, "train", "Train a model that estimates the trunk class from a reach",
                  "dtslab reach train trials/ --out model.toml | on all healthy people and on simulated people\n"
                  "dtslab reach train trials/ --out nn1.toml --net raw5 --subjects A,B,C | the network of the thesis\n"
                  "dtslab reach train --simulated --out model.toml | only on simulated people\n",
                  run_reach_train);
  reach::add_folder(command, arguments.folder);
  command.add_option("--out", arguments.out, "File to write")->option_text("MODEL")->required();
  command.add_option("--net", arguments.net, "recommended, or raw5 (one 5-8-3 network, as in the thesis); default: recommended")
      ->option_text("NET")
      ->check(CLI::IsMember({"recommended", "raw5"}));
  command.add_option("--subjects", arguments.subjects, "Subjects to train on, separated by commas. Default: all healthy people")
      ->option_text("A,B,...")
      ->delimiter(',');
  add_seed(command, arguments.seed, "The same seed and trials give the same model");
  CLI::Option* simulated = command.add_flag("--simulated", arguments.has_simulated_people,
                                            "raw5: train also on simulated people; without DIR: only on simulated people");
  command.add_flag("--recorded-only", arguments.is_recorded_only, "recommended: train without simulated people")->excludes(simulated);
  add_json(command, arguments.is_json);
}

void add_commands(cli::CommandLine& line, CLI::App& reach) {
  add_train(line, reach);
  add_classify(line, reach);
  add_judge(line, reach);
  add_exchange(line, reach);
}

}  // namespace dts::lab::training
