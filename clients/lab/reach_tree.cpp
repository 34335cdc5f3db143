// SPDX-License-Identifier: Apache-2.0
#include "lab/reach_tree.h"

#include <string>

#include "cli/validators.h"
#include "lab/reach/events_command.h"
#include "lab/recorded_reaches_command.h"
#include "lab/study/study_command.h"
#include "lab/training/training_commands.h"

namespace dts::lab {
namespace {

void add_folder(CLI::App& command, Arguments& arguments) {
  command
      .add_option("DIR", arguments.folder,
                  "Folder of trials: subjects.csv, trials.csv, sensors.csv, calibration.csv and the files with volts")
      ->required()
      ->option_text(" ");
}

void add_events(CommandTree& tree, CLI::App& reach) {
  Arguments& arguments = tree.arguments;
  CLI::App* events = add_command(tree, reach, "events", "Find the reach of each trial: the points P1, P2 and P3 of its transient",
                                 "dtslab reach events trials/ --out pred.csv | times in s from each trial's first sample\n"
                                 "dtslab reach events trials/ --out pred.csv --plot reaches.svg | also draw one trial per condition\n",
                                 reach::run_events);
  add_folder(*events, arguments);
  events->add_option("--out", arguments.out, "CSV file to write; the columns of class and trunk stay empty")
      ->option_text("PRED.csv")
      ->required();
  events->add_option("--plot", arguments.plot, "Draw the first trial of each condition; .svg or .png (needs gnuplot)")->option_text("FILE");
  add_json(*events, arguments);
}

void add_study(CommandTree& tree, CLI::App& reach) {
  Arguments& arguments = tree.arguments;
  CLI::App* study = add_command(tree, reach, "study",
                                "Repeat the experiments of chapters 5 and 6 of the thesis with simulated people, beside the printed values",
                                "dtslab reach study | five draws of eighteen people; takes half a minute\n"
                                "dtslab reach study --seed 7 --plot study.svg | other people; also draw confusions and trunk angles\n"
                                "dtslab reach study --json | every confusion of every draw, for a program\n",
                                run_reach_study);
  study->add_option("--seed", arguments.seed, "Seed of the first draw: the same seed gives the same people. Default: 1")
      ->option_text("N")
      ->check(cli::whole_number_between(0, 4294967295));
  study->add_option("--plot", arguments.plot, "Draw the confusions of the median draw and the trunk angles; .svg or .png (needs gnuplot)")
      ->option_text("FILE");
  add_json(*study, arguments);
}

void add_results(CommandTree& tree, CLI::App& reach) {
  Arguments& arguments = tree.arguments;
  CLI::App* results =
      add_command(tree, reach, "results", "Show the results of the reaching trials in a recording: per trial and per session",
                  "dtslab reach results session.xdf | class and trunk angle of each trial\n"
                  "dtslab reach results session.xdf --json | all values, for a program\n",
                  run_reach_results);
  results->add_option("FILE.xdf", arguments.first, "Recording of dtsd")->required()->option_text(" ");
  add_json(*results, arguments);
}

void add_train(CommandTree& tree, CLI::App& reach) {
  Arguments& arguments = tree.arguments;
  CLI::App* train = add_command(tree, reach, "train", "Train a model that estimates the trunk class from a reach",
                                "dtslab reach train trials/ --out model.toml | on all healthy people and on simulated people\n"
                                "dtslab reach train trials/ --out nn1.toml --net raw5 --subjects A,B,C | the network of the thesis\n"
                                "dtslab reach train --simulated --out model.toml | only on simulated people\n",
                                training::run_reach_train);
  train
      ->add_option("DIR", arguments.folder,
                   "Folder of trials: subjects.csv, trials.csv, sensors.csv, calibration.csv and the files with volts")
      ->option_text(" ");
  train->add_option("--out", arguments.out, "File to write")->option_text("MODEL")->required();
  train->add_option("--net", arguments.net, "recommended, or raw5 (one 5-8-3 network, as in the thesis); default: recommended")
      ->option_text("NET")
      ->check(CLI::IsMember({"recommended", "raw5"}));
  train->add_option("--subjects", arguments.subjects, "Subjects to train on, separated by commas. Default: all healthy people")
      ->option_text("A,B,...")
      ->delimiter(',');
  train->add_option("--seed", arguments.seed, "Seed of the random numbers: the same seed and trials give the same model. Default: 1")
      ->option_text("N")
      ->check(cli::whole_number_between(0, 4294967295));
  CLI::Option* simulated = train->add_flag("--simulated", arguments.has_simulated_people,
                                           "raw5: train also on simulated people; without DIR: only on simulated people");
  train->add_flag("--recorded-only", arguments.is_recorded_only, "recommended: train without simulated people")->excludes(simulated);
  add_json(*train, arguments);
}

void add_classify(CommandTree& tree, CLI::App& reach) {
  Arguments& arguments = tree.arguments;
  CLI::App* classify =
      add_command(tree, reach, "classify", "Classify the trunk movement of each trial",
                  "dtslab reach classify model.toml trials/ --out pred.csv | class, probability, trunk angle\n"
                  "dtslab reach classify model.toml trials/ --out pred.csv --calibrate max:3 | with the scale of each person\n",
                  training::run_reach_classify);
  classify->add_option("MODEL", arguments.model, "Made by dtslab reach train")->required()->option_text(" ");
  add_folder(*classify, arguments);
  classify->add_option("--out", arguments.out, "File to write")->option_text("PRED.csv")->required();
  classify->add_flag("!--no-reject", arguments.is_rejecting, "Always give the most probable class, never reject");
  classify
      ->add_option("--calibrate", arguments.calibrate, "max:3: adapt the model to each person with the first three trials at target max")
      ->option_text("max:N");
  add_json(*classify, arguments);
}

void add_exchange(CommandTree& tree, CLI::App& reach) {
  Arguments& arguments = tree.arguments;
  CLI::App* to_others =
      add_command(tree, reach, "export", "Write a model's networks as ONNX, for other programs to run",
                  "dtslab reach export model.toml --onnx model.onnx | features in, probabilities out\n", training::run_reach_export);
  to_others->add_option("MODEL", arguments.model, "Made by dtslab reach train")->required()->option_text(" ");
  to_others->add_option("--onnx", arguments.out, "File to write")->option_text("FILE")->required();
  CLI::App* from_others = add_command(tree, reach, "import", "Make a model from networks that another program trained",
                                      "dtslab reach import net.onnx --like model.toml --out model2.toml | network with the same layers\n"
                                      "dtslab reach import net.json --like nn1.toml --out nn2.toml | weights as JSON\n",
                                      training::run_reach_import);
  from_others->add_option("FILE", arguments.first, "Networks as .onnx or .json")->required()->option_text(" ");
  from_others->add_option("--like", arguments.model, "Model to copy everything else from: features, scaling, rules")
      ->option_text("MODEL")
      ->required();
  from_others->add_option("--out", arguments.out, "File to write")->option_text("MODEL2")->required();
}

}  // namespace

void add_reach(CommandTree& tree) {
  CLI::App* reach = cli::add_group(tree.line.app, "reach", "Find and classify reaches on the chair",
                                   "dtslab reach events trials/ --out pred.csv | P1, P2 and P3 of each trial\n"
                                   "dtslab reach train trials/ --out model.toml | a model of trunk movement\n");
  add_events(tree, *reach);
  add_train(tree, *reach);
  add_classify(tree, *reach);
  add_exchange(tree, *reach);
  add_study(tree, *reach);
  add_results(tree, *reach);
}

}  // namespace dts::lab
