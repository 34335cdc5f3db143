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
                  "Analyse at about this rate, lp10 only; default: CSV files as sampled, recordings 100, as dtsd does")
      ->option_text("HZ")
      ->check(cli::number_between(10.0, 100000.0, "hertz"));
  sway.add_option("--trim", arguments.trim_s, "Settling time to take off the beginning, after filtering; default: 0")
      ->option_text("S")
      ->check(cli::number_between(0.0, 3600.0, "seconds"));
  sway.add_option("--foot-length", arguments.foot_length_mm, "Gives AP_USE, the part of the foot that is used")
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
  CLI::App* sway = add_command(tree, tree.line.app, "sway", "Measure how steadily somebody stands: every measure of a centre of pressure",
                               "dtslab sway standing.csv | a table of all measures\n"
                               "dtslab sway standing.csv --profile asis --json | unfiltered, for a program\n"
                               "dtslab sway session.xdf | each trial of a recording, as dtsd measures it\n"
                               "dtslab sway sessions/ --table sway.csv | all recordings below a folder, one row a trial\n"
                               "dtslab sway open.csv closed.csv --label eyes=open,closed --compare | side by side, with Romberg quotients\n"
                               "dtslab sway session.xdf --trials 1,2 --compare | two trials of a recording\n",
                               steadiness::run_sway);
  sway->add_option("FILE", arguments.inputs, "CSV files with t_s,x_mm,y_mm, recordings of dtsd (.xdf, .xdf.part), folders of either")
      ->required()
      ->option_text("...");
  add_definition(*sway, arguments);
  sway->add_option("--label", arguments.labels, "Add a label to all trials; with as many values as files, to each its own")
      ->option_text("NAME=VALUE[,VALUE...]")
      ->allow_extra_args(false);
  sway->add_option("--trials", arguments.trials, "Of recordings only these, by number")
      ->option_text("N,...")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(cli::whole_number_between(1, 4294967295));
  sway->add_flag("--all", arguments.is_all, "Of recordings also trials that were redone, rejected or aborted");
  sway->add_flag("--compare", arguments.is_comparing, "Show two trials side by side");
  sway->add_option("--table", arguments.table, "Write one row for each trial, with all measures")
      ->option_text("OUT.csv")
      ->check(cli::text_of(1, 4096));
  add_json(*sway, tree.arguments);
  tree.line.glossaries[sway] = words_of_results();
}

void add_telling_apart(CommandTree& tree) {
  steadiness::SteadinessArguments& arguments = tree.arguments.steadiness;
  CLI::App* group = cli::add_group(tree.line.app, "steadiness", "Tell conditions or groups of people apart by their sway",
                                   "dtslab steadiness train sway.csv --label eyes --out eyes.json | is there anything to be told?\n"
                                   "dtslab steadiness classify eyes.json new.csv | what would it say?\n");
  CLI::App* train = add_command(tree, *group, "train", "Train a linear discriminant and judge it on people that it has not seen",
                                "dtslab steadiness train sway.csv --label eyes --out eyes.json | by all core measures that every row has\n"
                                "dtslab steadiness train sway.csv --label group --measures MVELO,PEA95_F --out group.json | by two\n",
                                steadiness::run_train);
  train->add_option("TABLE.csv", arguments.table, "As dtslab sway --table writes it")->required()->option_text(" ");
  train->add_option("--label", arguments.label, "Column that says what is to be told")->option_text("COLUMN")->required();
  train->add_option("--out", arguments.out, "File to write")->option_text("MODEL.json")->required();
  train->add_option("--measures", arguments.measures, "Symbols with commas between; default: the core measures that every row has")
      ->option_text("A,B,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  add_json(*train, tree.arguments);

  CLI::App* classify = add_command(tree, *group, "classify", "Tell from each row of a table what its label would be",
                                   "dtslab steadiness classify eyes.json new.csv | a table\n"
                                   "dtslab steadiness classify eyes.json new.csv --out pred.csv | as a file\n",
                                   steadiness::run_classify);
  classify->add_option("MODEL.json", arguments.model, "Made by dtslab steadiness train")->required()->option_text(" ");
  classify->add_option("TABLE.csv", arguments.table, "As dtslab sway --table writes it, by the same definition")
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
