// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <string>
#include <utility>

#include "cli/exit_status.h"
#include "files/trunk_model_file.h"
#include "files/whole_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/training/onnx_file.h"
#include "lab/training/training_commands.h"

namespace dts::lab::training {
namespace {

struct ExportArguments {
  std::string model;
  std::string out;
};

struct ImportArguments {
  std::string networks;  ///< .onnx or .json
  std::string like;      ///< Model with all the rest.
  std::string out;
};

/// Returns `like` with networks that were trained elsewhere.
core::Result<classifier::TrunkModel> with_networks(const classifier::TrunkModel& like, ForeignNetworks foreign, const std::string& file) {
  classifier::TrunkModelForm form = like.form();
  const std::size_t hidden = form.general.networks.front().hidden_count();
  for (const classifier::Network& network : foreign.networks) {
    if (network.input_count() == form.general.inputs.size() && network.hidden_count() == hidden) continue;
    return core::fail(core::ErrorCode::InvalidArgument,
                      file + ": a network is " + std::to_string(network.input_count()) + "-" + std::to_string(network.hidden_count()) +
                          "-3, the model's are " + std::to_string(form.general.inputs.size()) + "-" + std::to_string(hidden) + "-3",
                      "use a network with the same layers");
  }
  if (!foreign.inputs.empty()) {
    for (std::size_t k = 0; k < foreign.inputs.size(); ++k) {
      if (foreign.inputs[k].feature == form.general.inputs[k].feature) continue;
      return core::fail(core::ErrorCode::InvalidArgument, file + ": input " + std::to_string(k + 1) + " is not the input of the model",
                        "use the features of the model, in the same order");
    }
    form.general.inputs = std::move(foreign.inputs);
  }
  form.general.networks = std::move(foreign.networks);
  // Figures measured with the old networks are not valid for these; the validation accuracy stays as the model's own statement about its
  // task.
  const double validation_accuracy = form.figures.validation_accuracy;
  form.figures = {.validation_accuracy = validation_accuracy};
  form.facts.software = ("networks imported from " + std::filesystem::path(file).filename().string()).substr(0, 150);
  return classifier::TrunkModel::create(std::move(form));
}

int run_reach_export(const ExportArguments& arguments, cli::Console& console) {
  if (const auto free = check_out(arguments.out, {arguments.model}); !free) return fail_with(console, free.error());
  files::Problems problems;
  const auto model = files::load_trunk_model(arguments.model, problems);
  if (!model) return report_problems(console, problems);
  const auto written = files::write_whole_file(arguments.out, onnx_text(*model));
  if (!written) return fail_with(console, written.error());
  console.out << arguments.out << ": " << model->form().general.networks.size() << " networks as ONNX\n";
  return cli::kOk;
}

int run_reach_import(const ImportArguments& arguments, cli::Console& console) {
  if (const auto free = check_out(arguments.out, {arguments.like, arguments.networks}); !free) return fail_with(console, free.error());
  files::Problems problems;
  const auto like = files::load_trunk_model(arguments.like, problems);
  if (!like) return report_problems(console, problems);
  const bool is_json = std::filesystem::path(arguments.networks).extension() == ".json";
  auto foreign = is_json ? read_network_json(arguments.networks) : read_onnx(arguments.networks);
  if (!foreign) return fail_with(console, foreign.error());
  const auto model = with_networks(*like, std::move(*foreign), arguments.networks);
  if (!model) return fail_with(console, model.error());
  if (const auto saved = files::save_trunk_model(arguments.out, *model); !saved) return fail_with(console, saved.error());
  warn(console, "the accuracy of " + arguments.out + " is not measured: test the model on trials before use");
  return cli::kOk;
}

}  // namespace

void add_exchange(cli::CommandLine& line, CLI::App& reach) {
  const auto [to_others, exported] =
      add_command(line, reach, "export", "Write a model's networks as ONNX, for other programs to run",
                  "dtslab reach export model.toml --onnx model.onnx | features in, probabilities out\n", run_reach_export);
  to_others.add_option("MODEL", exported.model, "Made by dtslab reach train")->required()->option_text(" ");
  to_others.add_option("--onnx", exported.out, "File to write")->option_text("FILE")->required();
  const auto [from_others, imported] = add_command(line, reach, "import", "Make a model from networks that another program trained",
                                                   "dtslab reach import net.onnx --like model.toml --out model2.toml | network with the same layers\n"
                                                   "dtslab reach import net.json --like nn1.toml --out nn2.toml | weights as JSON\n",
                                                   run_reach_import);
  from_others.add_option("FILE", imported.networks, "Networks as .onnx or .json")->required()->option_text(" ");
  from_others.add_option("--like", imported.like, "Model to copy everything else from: features, scaling, rules")
      ->option_text("MODEL")
      ->required();
  from_others.add_option("--out", imported.out, "File to write")->option_text("MODEL2")->required();
}

}  // namespace dts::lab::training
