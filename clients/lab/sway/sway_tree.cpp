// SPDX-License-Identifier: Apache-2.0
#include "lab/sway/sway_tree.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "cli/validators.h"
#include "lab/sway/sway_commands.h"
#include "posturography/cop_series.h"
#include "posturography/measure.h"

namespace dts::lab {
namespace {

void add_definition(CLI::App& sway, steadiness::SwayArguments& arguments) {
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

void add_measuring(CommandTree& tree) {
  steadiness::SwayArguments& arguments = tree.arguments.sway;
  CLI::App* sway =
      add_command(tree, tree.line.app, "sway", "Measure the sway of a standing person: every measure of the centre of pressure",
                  "dtslab sway standing.csv | all measures in a table\n"
                  "dtslab sway standing.csv --profile asis --json | unfiltered, for a program\n"
                  "dtslab sway session.xdf | each trial of a recording, as dtsd measures it\n"
                  "dtslab sway sessions/ --table sway.csv | all recordings below a folder, one row per trial\n"
                  "dtslab sway open.csv closed.csv --label eyes=open,closed --compare | side by side, with Romberg quotients\n"
                  "dtslab sway session.xdf --trials 1,2 --compare | two trials of a recording\n",
                  steadiness::run_sway);
  sway->add_option("FILE", arguments.inputs, "CSV files with t_s,x_mm,y_mm, recordings of dtsd (.xdf, .xdf.part), folders of either")
      ->required()
      ->option_text("...");
  add_definition(*sway, arguments);
  sway->add_option("--label", arguments.labels, "Add a label to the trials: one value for all files, or one value per file")
      ->option_text("NAME=VALUE[,VALUE...]")
      ->allow_extra_args(false);
  sway->add_option("--trials", arguments.trials, "Numbers of the trials to measure, recordings only")
      ->option_text("N,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(cli::whole_number_between(1, 4294967295));
  sway->add_flag("--all", arguments.is_all, "Also measure trials that were redone, rejected or aborted, recordings only");
  sway->add_flag("--compare", arguments.is_comparing, "Show two trials side by side");
  sway->add_option("--table", arguments.table, "CSV file to write: one row per trial, all measures")
      ->option_text("OUT.csv")
      ->check(cli::text_of(1, 4096));
  add_json(*sway, tree.arguments);
  tree.line.glossaries[sway] = words_of_results();
}

void add_telling_apart(CommandTree& tree) {
  steadiness::SteadinessArguments& arguments = tree.arguments.steadiness;
  CLI::App* group = cli::add_group(tree.line.app, "steadiness", "Classify conditions or groups of people by their sway",
                                   "dtslab steadiness train sway.csv --label eyes --out eyes.json | train, and show how well it works\n"
                                   "dtslab steadiness classify eyes.json new.csv | classify new trials\n");
  CLI::App* train =
      add_command(tree, *group, "train", "Train a linear discriminant and test it on people left out of the training",
                  "dtslab steadiness train sway.csv --label eyes --out eyes.json | with all core measures that every row has\n"
                  "dtslab steadiness train sway.csv --label group --measures MVELO,PEA95_F --out group.json | with two measures\n",
                  steadiness::run_train);
  train->add_option("TABLE.csv", arguments.table, "Table from dtslab sway --table")->required()->option_text(" ");
  train->add_option("--label", arguments.label, "Column with the label to predict")->option_text("COLUMN")->required();
  train->add_option("--out", arguments.out, "File to write")->option_text("MODEL.json")->required();
  train
      ->add_option("--measures", arguments.measures,
                   "Symbols of the measures, separated by commas. Default: the core measures that every row has")
      ->option_text("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  add_json(*train, tree.arguments);

  CLI::App* classify = add_command(tree, *group, "classify", "Predict the label of each row of a table",
                                   "dtslab steadiness classify eyes.json new.csv | a table\n"
                                   "dtslab steadiness classify eyes.json new.csv --out pred.csv | write a file\n",
                                   steadiness::run_classify);
  classify->add_option("MODEL.json", arguments.model, "Made by dtslab steadiness train")->required()->option_text(" ");
  classify->add_option("TABLE.csv", arguments.table, "Table from dtslab sway --table, with the same profile and rate")
      ->required()
      ->option_text(" ");
  classify->add_option("--out", arguments.out, "File to write")->option_text("PRED.csv");
  add_json(*classify, tree.arguments);
}

}  // namespace

void add_sway(CommandTree& tree) {
  add_measuring(tree);
  add_telling_apart(tree);
}

}  // namespace dts::lab
