// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "files/trunk_model_file.h"
#include "lab/base/command.h"
#include "lab/base/problems.h"
#include "lab/reach/events_command.h"
#include "lab/reach/predictions.h"
#include "lab/reach/trial_set.h"
#include "lab/training/training_commands.h"

namespace dts::lab::training {
namespace {

struct ClassifyArguments {
  std::string model;
  std::string folder;
  std::string out;
  bool is_rejecting = true;  ///< Doubtful reaches are rejected.
  std::string calibrate;     ///< "max:3": use each subject's first three trials at that target; empty: none.
  bool is_json = false;
};

using classifier::SubjectCalibration;
using Reaches = std::vector<std::optional<core::ReachEvent>>;

/// Parsed "max:3": the first three trials at that target.
struct OwnScale {
  std::string condition;
  std::size_t count = 0;
};

core::Result<std::optional<OwnScale>> own_scale_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto colon = text.find(':');
  OwnScale own{.condition = text.substr(0, colon)};
  const std::string number = colon == std::string::npos ? "" : text.substr(colon + 1);
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), own.count);
  const bool is_number = error == std::errc() && end == number.data() + number.size() && !number.empty();
  if (own.condition == "max" && is_number && own.count >= classifier::kCalibrationReaches && own.count <= 1000) return own;
  return core::fail(core::ErrorCode::InvalidArgument, "--calibrate " + text + " is unknown", "use --calibrate max:3");
}

/// Returns one calibration per subject; none for a subject without usable maximum reaches.
std::vector<std::optional<SubjectCalibration>> calibrations_of(const reach::TrialSet& set, const Reaches& reaches, const OwnScale& own,
                                                               cli::Console& console) {
  std::vector<std::vector<core::ReachFeatures>> maximum(set.subjects.size());
  std::vector<std::size_t> taken(set.subjects.size());
  for (std::size_t k = 0; k < set.trials.size(); ++k) {
    const reach::Trial& trial = set.trials[k];
    if (trial.condition != own.condition || taken[trial.subject]++ >= own.count) continue;
    if (reaches[k] && (reaches[k]->flags & classifier::kUnfitFlags) == 0) maximum[trial.subject].push_back(reaches[k]->features);
  }
  std::vector<std::optional<SubjectCalibration>> calibrations;
  for (std::size_t subject = 0; subject < set.subjects.size(); ++subject) {
    const physics::Person& person = set.subjects[subject].person;
    if (!set.subjects[subject].is_healthy) {
      warn(console,
           "subject " + set.subjects[subject].name + " has no personal scale: after a stroke, the distance does not predict trunk flexion");
      calibrations.emplace_back();
      continue;
    }
    const auto calibration = classifier::calibrate_subject(maximum[subject], physics::trunk_flexion_deg(person, person.max_reach_cm));
    if (!calibration)
      warn(console, "subject " + set.subjects[subject].name + " has no personal scale: " + core::to_string(calibration.error()));
    calibrations.push_back(calibration ? std::optional(*calibration) : std::nullopt);
  }
  return calibrations;
}

void print_counts(const std::vector<reach::Prediction>& predictions, const ClassifyArguments& arguments, cli::Console& console) {
  std::map<int, std::size_t> counts;
  std::size_t missing = 0;
  for (const reach::Prediction& prediction : predictions) {
    if (prediction.movement) {
      ++counts[static_cast<int>(prediction.movement->trunk_class)];
    } else {
      ++missing;
    }
  }
  cli::Json json{{"file", arguments.out}, {"trials", predictions.size()}, {"not_found", missing}, {"rejected", counts[-1]}};
  for (int trunk_class = 0; trunk_class <= 3; ++trunk_class) json["class_" + std::to_string(trunk_class)] = counts[trunk_class];
  if (arguments.is_json) {
    console.out << cli::document(json);
    return;
  }
  std::string text = arguments.out + ": " + std::to_string(predictions.size()) + " trials, ";
  for (int trunk_class = 0; trunk_class <= 3; ++trunk_class) {
    text += std::to_string(counts[trunk_class]) + " of class " + std::to_string(trunk_class) + ", ";
  }
  console.out << text << counts[-1] << " rejected, " << missing << " without a reach\n";
}

int run_reach_classify(const ClassifyArguments& arguments, cli::Console& console) {
  const auto own = own_scale_of(arguments.calibrate);
  if (!own) return fail_with(console, own.error());
  if (const auto free = check_out(arguments.out, {arguments.folder, arguments.model}); !free) return fail_with(console, free.error());
  files::Problems problems;
  const auto model = files::load_trunk_model(arguments.model, problems);
  const auto set = reach::read_trial_set(arguments.folder, problems);
  if (!problems.empty() || !model) return report_problems(console, problems);
  const Reaches reaches = [&] {
    cli::Progress progress(console, "finding reaches");
    return reach::find_reaches(set, [&](double part) { progress.report(part); });
  }();
  std::vector<std::optional<SubjectCalibration>> calibrations(set.subjects.size());
  if (*own) calibrations = calibrations_of(set, reaches, **own, console);
  std::vector<reach::Prediction> predictions;
  for (std::size_t k = 0; k < set.trials.size(); ++k) {
    const reach::Trial& trial = set.trials[k];
    reach::Prediction prediction{
        .subject = set.subjects[trial.subject].name, .trial = trial.number, .rate = trial.rate, .reach = reaches[k]};
    const SubjectCalibration* const subject = calibrations[trial.subject] ? &*calibrations[trial.subject] : nullptr;
    if (reaches[k]) {
      const auto& [features, flags] = std::pair(reaches[k]->features, reaches[k]->flags);
      prediction.movement =
          arguments.is_rejecting ? model->classify(features, flags, subject) : model->best_guess(features, flags, subject);
    }
    predictions.push_back(std::move(prediction));
  }
  if (const auto written = reach::write_predictions(predictions, arguments.out); !written) return fail_with(console, written.error());
  print_counts(predictions, arguments, console);
  return cli::kOk;
}

}  // namespace

void add_classify(cli::CommandLine& line, CLI::App& reach) {
  const auto [command, arguments] =
      add_command(line, reach, "classify", "Classify the trunk movement of each trial",
                  "dtslab reach classify model.toml trials/ --out pred.csv | class, probability, trunk angle\n"
                  "dtslab reach classify model.toml trials/ --out pred.csv --calibrate max:3 | with the scale of each person\n",
                  run_reach_classify);
  command.add_option("MODEL", arguments.model, "Made by dtslab reach train")->required()->option_text(" ");
  reach::add_folder(command, arguments.folder)->required();
  command.add_option("--out", arguments.out, "File to write")->option_text("PRED.csv")->required();
  command.add_flag("!--no-reject", arguments.is_rejecting, "Always give the most probable class, never reject");
  command
      .add_option("--calibrate", arguments.calibrate, "max:3: adapt the model to each person with the first three trials at target max")
      ->option_text("max:N");
  add_json(command, arguments.is_json);
}

}  // namespace dts::lab::training
