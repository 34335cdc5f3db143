// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>

#include "files/toml_text.h"
#include "files/trunk_model_file.h"
#include "record/sha256.h"

namespace dts::files {
namespace {

using classifier::FeatureRange;
using classifier::TrunkModelForm;

constexpr std::string_view kModelHead =
    R"(# Model of trunk movement, made by dtslab reach train. Do not edit: train again instead.
#
# A feature x is scaled to 2 (x - minimum) / (maximum - minimum) - 1 (kind "recommended": then clipped to -1..1). A network has one hidden
# layer of tanh nodes; its weights are hidden x inputs row by row, hidden biases, 3 x hidden row by row, output biases. Its outputs,
# divided by their sum, are averaged over the networks, raised to 1 / temperature and divided by their sum again: the probabilities of
# class 1, 2 and 3. A quadratic has the coefficients of 1, each x_i, each x_i x_j with i <= j, and gives the sine of the trunk's flexion
# ([own_angle]: its part of the sine at the person's own maximum). residual_deg is half of the 90 % interval for angles of class 1, 2, 3.
# sha256 is that of all lines below it but comments and empty ones.
)";

class ModelWriter {
 public:
  void raw(std::string_view text) { out_ << text; }
  void text(std::string_view key, std::string_view value) { out_ << key << " = " << toml_quoted(value) << '\n'; }
  void number(std::string_view key, double value) { out_ << key << " = " << toml_number(value) << '\n'; }
  void numbers(std::string_view key, std::span<const double> values) { out_ << key << " = " << toml_numbers(values) << '\n'; }
  void count(std::string_view key, std::uint64_t value) { out_ << key << " = " << value << '\n'; }

  /// Writes a number; leaves it out if it was not measured (NaN).
  void figure(std::string_view key, double value) {
    if (std::isfinite(value)) number(key, value);
  }

  void texts(std::string_view key, const std::vector<std::string>& values) {
    out_ << key << " = [";
    for (std::size_t k = 0; k < values.size(); ++k) out_ << (k == 0 ? "" : ", ") << toml_quoted(values[k]);
    out_ << "]\n";
  }

  void inputs(const std::vector<FeatureRange>& inputs) {
    std::vector<std::string> names;
    std::vector<double> minima;
    std::vector<double> maxima;
    for (const FeatureRange& input : inputs) {
      names.emplace_back(name_of(input.feature));
      minima.push_back(input.minimum);
      maxima.push_back(input.maximum);
    }
    texts("features", names);
    numbers("minimum", minima);
    numbers("maximum", maxima);
  }

  void ensemble(std::string_view table, const classifier::Ensemble& ensemble) {
    out_ << "\n[" << table << "]\n";
    inputs(ensemble.inputs);
    number("temperature", ensemble.temperature);
    for (const classifier::Network& network : ensemble.networks) {
      out_ << "[[" << table << ".network]]\n";
      count("hidden", network.hidden_count());
      text("output", network.output() == classifier::OutputKind::Softmax ? "softmax" : "logistic");
      numbers("weights", network.weights());
    }
  }

  void angle(std::string_view table, const classifier::AngleModel& angle) {
    out_ << "\n[" << table << "]\n";
    inputs(angle.sine.inputs);
    numbers("coefficients", angle.sine.coefficients);
    numbers("residual_deg", angle.residual_deg);
  }

  void arm_alone(const classifier::ArmAloneRule& rule) {
    raw("\n# Probability that only the arm moved: logistic of a quadratic. Class 0 from none_from on.\n[arm_alone]\n");
    inputs(rule.logit.inputs);
    numbers("coefficients", rule.logit.coefficients);
    number("none_from", rule.none_from);
  }

  void training(const classifier::TrainingFacts& facts) {
    raw("\n[training]\n");
    text("data_sha256", facts.data_sha256);
    texts("subjects", facts.subjects);
    count("simulated_subjects", facts.simulated_subjects);
    count("trials", facts.trials);
    text("seed", std::to_string(facts.seed));
    text("software", facts.software);
    text("created_utc", facts.created_utc);
  }

  void figures(const classifier::ModelFigures& figures) {
    raw("\n# Validation: trials of the same people. Left out: each person by a model without that person, which is what to expect of "
        "others.\n");
    raw("[figures]\n");
    figure("validation_accuracy", figures.validation_accuracy);
    figure("left_out_accuracy", figures.left_out_accuracy);
    figure("left_out_own_accuracy", figures.left_out_own_accuracy);
    figure("left_out_kept", figures.left_out_kept);
    figure("left_out_kept_accuracy", figures.left_out_kept_accuracy);
    figure("left_out_angle_rms_deg", figures.left_out_angle_rms_deg);
    figure("left_out_angle_coverage", figures.left_out_angle_coverage);
    figure("expected_calibration_error", figures.expected_calibration_error);
  }

  [[nodiscard]] std::string result() const { return out_.str(); }

 private:
  std::ostringstream out_;
};

}  // namespace

namespace {

/// Returns the model's text without its head (comments, format, checksum).
std::string body_of(const TrunkModelForm& form) {
  ModelWriter writer;
  writer.text("kind", form.kind == classifier::ModelKind::Raw5 ? "raw5" : "recommended");
  writer.number("reject_below", form.reject_below);
  writer.number("p1_minimum_mm", form.p1_minimum_mm);
  writer.number("p1_maximum_mm", form.p1_maximum_mm);
  writer.training(form.facts);
  writer.figures(form.figures);
  if (form.angle) writer.angle("angle", *form.angle);
  if (form.own_angle) writer.angle("own_angle", *form.own_angle);
  if (form.arm_alone) writer.arm_alone(*form.arm_alone);
  writer.ensemble("general", form.general);
  if (form.own) writer.ensemble("own", *form.own);
  return writer.result();
}

std::string sha256_of_body(const std::string& body) {
  std::istringstream lines(body);
  std::string values;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && !line.starts_with('#')) values += line + '\n';
  }
  return record::sha256_of(values);
}

}  // namespace

std::string trunk_model_sha256(const classifier::TrunkModel& model) { return sha256_of_body(body_of(model.form())); }

std::string trunk_model_text(const classifier::TrunkModel& model) {
  const std::string body = body_of(model.form());
  ModelWriter writer;
  writer.raw(kModelHead);
  writer.raw("format = 1\n");
  writer.text("sha256", sha256_of_body(body));
  writer.raw(body);
  return writer.result();
}

}  // namespace dts::files
