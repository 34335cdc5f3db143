// SPDX-License-Identifier: Apache-2.0
#include "files/trunk_model_file.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>
#include <vector>

#include "files/whole_file.h"

namespace dts::files {
namespace {

using classifier::Ensemble;
using classifier::FeatureRange;
using classifier::ModelKind;
using classifier::Network;
using classifier::TrunkModelForm;

constexpr std::int64_t kModelFormat = 1;
constexpr std::size_t kMostSubjects = 1000;
constexpr std::int64_t kMostTrials = 100'000'000;
constexpr std::size_t kSha256Digits = 64;
constexpr double kLargestWeight = 1e30;

double required_number(TomlReader& reader, std::string_view key, double fallback, double minimum, double maximum) {
  reader.require(key);
  return reader.number(key, fallback, minimum, maximum);
}

std::vector<double> read_finite(TomlReader& reader, std::string_view key, std::size_t count) {
  return read_list(reader, key, reader.node(key), count, count, kLargestWeight);
}

std::vector<FeatureRange> read_inputs(TomlReader& reader) {
  reader.require("features");
  const auto names = reader.texts("features", {});
  if (names.empty() || names.size() > Network::kMaxInputs) {
    reader.report("features", "features must be a list of 1 to " + std::to_string(Network::kMaxInputs) + " names");
    return {};
  }
  const auto minima = read_finite(reader, "minimum", names.size());
  const auto maxima = read_finite(reader, "maximum", names.size());
  std::vector<FeatureRange> inputs;
  for (std::size_t k = 0; k < names.size() && minima.size() == maxima.size() && !minima.empty(); ++k) {
    const auto feature = classifier::parse_reach_feature(names[k]);
    if (!feature) {
      reader.report("features", "feature \"" + names[k].substr(0, kLongestText) + "\" is not known");
      continue;
    }
    if (!(minima[k] < maxima[k])) reader.report("minimum", names[k] + ": the minimum is not below the maximum");
    inputs.push_back({*feature, minima[k], maxima[k]});
  }
  return inputs;
}

void read_network(TomlReader& reader, std::size_t inputs, std::vector<Network>& networks) {
  reader.require("hidden");
  const auto hidden = static_cast<std::size_t>(reader.integer("hidden", 1, 1, static_cast<std::int64_t>(Network::kMaxHidden)));
  const auto output =
      reader.choice("output", {"logistic", "softmax"}) == "softmax" ? classifier::OutputKind::Softmax : classifier::OutputKind::Logistic;
  auto weights = read_finite(reader, "weights", Network::weight_count(inputs, hidden));
  reader.finish();
  if (weights.empty()) return;
  auto network = Network::create(inputs, hidden, output, std::move(weights));
  if (network) {
    networks.push_back(std::move(*network));
  } else {
    reader.report("weights", network.error().what);
  }
}

Ensemble read_ensemble(TomlReader reader) {
  Ensemble ensemble{.inputs = read_inputs(reader), .networks = {}};
  ensemble.temperature = reader.number("temperature", 1.0, TrunkModelForm::kLowestTemperature, TrunkModelForm::kHighestTemperature);
  auto networks = reader.tables("network");
  if (networks.empty() || networks.size() > Ensemble::kMaxNetworks) {
    reader.report("network",
                  "there must be 1 to " + std::to_string(Ensemble::kMaxNetworks) + " networks, not " + std::to_string(networks.size()));
  } else if (!ensemble.inputs.empty()) {
    for (TomlReader& network : networks) read_network(network, ensemble.inputs.size(), ensemble.networks);
  }
  reader.finish();
  return ensemble;
}

classifier::Quadratic read_quadratic(TomlReader& reader) {
  classifier::Quadratic quadratic{.inputs = read_inputs(reader), .coefficients = {}};
  if (!quadratic.inputs.empty()) {
    quadratic.coefficients = read_finite(reader, "coefficients", classifier::Quadratic::term_count(quadratic.inputs.size()));
  }
  return quadratic;
}

classifier::AngleModel read_angle(TomlReader reader) {
  classifier::AngleModel angle{.sine = read_quadratic(reader)};
  const auto residuals = read_finite(reader, "residual_deg", angle.residual_deg.size());
  std::copy(residuals.begin(), residuals.end(), angle.residual_deg.begin());
  reader.finish();
  return angle;
}

classifier::ArmAloneRule read_arm_alone(TomlReader reader) {
  classifier::ArmAloneRule rule{.logit = read_quadratic(reader)};
  rule.none_from = required_number(reader, "none_from", 0.9, TrunkModelForm::kLowestNoneFrom, 1.0);
  reader.finish();
  return rule;
}

/// Reads the seed from a text, because it is an unsigned 64-bit number and TOML's integers are signed.
std::uint64_t read_seed(TomlReader& reader) {
  const std::string text = reader.short_text("seed");
  std::uint64_t seed = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seed);
  if (error != std::errc() || end != text.data() + text.size()) reader.report("seed", "seed must be a whole number in quotes");
  return seed;
}

classifier::TrainingFacts read_training(TomlReader reader) {
  for (const char* key : {"data_sha256", "trials", "seed", "software"}) reader.require(key);
  classifier::TrainingFacts facts;
  facts.data_sha256 = reader.short_text("data_sha256");
  const bool is_hash =
      facts.data_sha256.size() == kSha256Digits && facts.data_sha256.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (!is_hash) reader.report("data_sha256", "data_sha256 must be 64 hexadecimal digits");
  facts.subjects = reader.texts("subjects", {});
  if (facts.subjects.size() > kMostSubjects)
    reader.report("subjects", "there are more than " + std::to_string(kMostSubjects) + " subjects");
  facts.simulated_subjects =
      static_cast<std::uint32_t>(reader.integer("simulated_subjects", 0, 0, std::int64_t{std::numeric_limits<std::int32_t>::max()}));
  facts.trials = static_cast<std::uint32_t>(reader.integer("trials", 0, 1, kMostTrials));
  facts.seed = read_seed(reader);
  facts.software = reader.short_text("software");
  facts.created_utc = reader.short_text("created_utc");
  reader.finish();
  return facts;
}

double optional_figure(TomlReader& reader, std::string_view key, double maximum) {
  return reader.has(key) ? reader.number(key, 0.0, 0.0, maximum) : classifier::ModelFigures::kUnknown;
}

classifier::ModelFigures read_model_figures(TomlReader reader) {
  classifier::ModelFigures figures;
  figures.validation_accuracy = required_number(reader, "validation_accuracy", 1.0, 0.0, 1.0);
  if (figures.validation_accuracy < TrunkModelForm::kLowestValidationAccuracy) {
    reader.report("validation_accuracy", "validation_accuracy is below 0.9: the training failed, do not use this model");
  }
  figures.left_out_accuracy = optional_figure(reader, "left_out_accuracy", 1.0);
  figures.left_out_own_accuracy = optional_figure(reader, "left_out_own_accuracy", 1.0);
  figures.left_out_kept = optional_figure(reader, "left_out_kept", 1.0);
  figures.left_out_kept_accuracy = optional_figure(reader, "left_out_kept_accuracy", 1.0);
  figures.left_out_angle_rms_deg = optional_figure(reader, "left_out_angle_rms_deg", 180.0);
  figures.left_out_angle_coverage = optional_figure(reader, "left_out_angle_coverage", 1.0);
  figures.expected_calibration_error = optional_figure(reader, "expected_calibration_error", 1.0);
  reader.finish();
  return figures;
}

TrunkModelForm read_form(TomlReader& top) {
  TrunkModelForm form;
  for (const char* key : {"format", "kind", "training", "figures", "general"}) top.require(key);
  if (const auto format = top.integer("format", kModelFormat, 0, 1'000'000); format != kModelFormat) {
    top.report("format", "format " + std::to_string(format) + " is not known; this program reads format " + std::to_string(kModelFormat));
  }
  form.kind = top.choice("kind", {"raw5", "recommended"}) == "raw5" ? ModelKind::Raw5 : ModelKind::Recommended;
  form.reject_below = required_number(top, "reject_below", 0.9, 0.0, 1.0);
  form.p1_minimum_mm = required_number(top, "p1_minimum_mm", 1.0, TrunkModelForm::kSmallestP1Mm, TrunkModelForm::kLargestP1Mm);
  form.p1_maximum_mm = required_number(top, "p1_maximum_mm", 2.0, TrunkModelForm::kSmallestP1Mm, TrunkModelForm::kLargestP1Mm);
  form.facts = read_training(top.table("training"));
  form.figures = read_model_figures(top.table("figures"));
  form.general = read_ensemble(top.table("general"));
  if (top.has("own")) form.own = read_ensemble(top.table("own"));
  if (top.has("angle")) form.angle = read_angle(top.table("angle"));
  if (top.has("own_angle")) form.own_angle = read_angle(top.table("own_angle"));
  if (top.has("arm_alone")) form.arm_alone = read_arm_alone(top.table("arm_alone"));
  top.finish();
  return form;
}

}  // namespace

core::Status save_trunk_model(const std::string& file, const classifier::TrunkModel& model) {
  return write_whole_file(file, trunk_model_text(model));
}

std::optional<classifier::TrunkModel> load_trunk_model(const std::string& file, Problems& problems) {
  const auto table = parse_toml(file, problems);
  if (!table) return std::nullopt;
  TomlReader top(&*table, "", file, problems);
  return read_trunk_model(top, problems);
}

std::optional<classifier::TrunkModel> read_trunk_model(TomlReader& top, Problems& problems) {
  const std::size_t known_problems = problems.size();
  const bool has_sha256 = top.has("sha256");
  const std::string said_sha256 = has_sha256 ? top.short_text("sha256") : "";
  auto form = read_form(top);
  if (problems.size() > known_problems) return std::nullopt;
  auto model = classifier::TrunkModel::create(std::move(form));
  if (!model) {
    top.report("kind", core::to_string(model.error()));
    return std::nullopt;
  }
  // Models in recordings of older dtsd versions have no checksum; the recording's own checksums protect them.
  if (const std::string sha256 = trunk_model_sha256(*model); has_sha256 && sha256 != said_sha256) {
    top.report("sha256", "the model is damaged or was edited: its sha256 is " + sha256 +
                             "; copy it again, or train it again with dtslab reach train");
    return std::nullopt;
  }
  return std::move(*model);
}

}  // namespace dts::files
