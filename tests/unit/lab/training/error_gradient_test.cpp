// SPDX-License-Identifier: Apache-2.0
#include "lab/training/error_gradient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lab/training/conjugate_gradient.h"
#include "lab/training/network_json.h"
#include "lab/training/network_training.h"

namespace dts::lab::training {
namespace {

using classifier::OutputKind;

std::filesystem::path reference(const std::string& name) {
  return std::filesystem::path(DTS_SOURCE_DIR).parent_path() / "shared" / "data" / "reach" / "reference" / name;
}

Batch small_batch(std::size_t inputs) {
  Batch batch{.input_count = inputs, .inputs = {}, .classes = {}};
  Random random(5);
  for (std::size_t row = 0; row < 7; ++row) {
    for (std::size_t k = 0; k < inputs; ++k) batch.inputs.push_back(random.uniform(-1.0, 1.0));
    batch.classes.push_back(row % 3);
  }
  return batch;
}

class GradientOf : public testing::TestWithParam<OutputKind> {};

TEST_P(GradientOf, RandomNetwork_AgreesWithDifferences) {
  const Batch batch = small_batch(4);
  const NetworkError error(batch, 6, GetParam(), 0.01);
  Random random(9);
  auto weights = first_weights(4, 6, random);
  std::vector<double> gradient(weights.size());

  const double value = error.gradient(weights, gradient);

  EXPECT_NEAR(value, error.error(weights), 1e-14);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double kept = weights[k];
    weights[k] = kept + 1e-5;
    const double above = error.error(weights);
    weights[k] = kept - 1e-5;
    const double below = error.error(weights);
    weights[k] = kept;
    EXPECT_NEAR(gradient[k], (above - below) / 2e-5, 1e-8) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Both, GradientOf, testing::Values(OutputKind::Logistic, OutputKind::Softmax));

TEST(NetworkError, GradientFixture_Within1e6) {
  std::ifstream file(reference("grad_fixture.json"));
  if (!file) GTEST_SKIP() << "the reference data are not here";
  const auto json = nlohmann::json::parse(file);
  Batch batch{.input_count = 5, .inputs = {}, .classes = {}};
  for (const auto& row : json.at("X")) {
    for (const double value : row) batch.inputs.push_back(value);
  }
  for (const auto& row : json.at("T")) {
    const std::vector<double> targets = row;
    batch.classes.push_back(static_cast<std::size_t>(std::max_element(targets.begin(), targets.end()) - targets.begin()));
  }
  const std::vector<double> weights = json.at("w");
  const std::vector<double> wanted = json.at("grad");
  std::vector<double> gradient(weights.size());

  const double error = NetworkError(batch, 8, OutputKind::Logistic).gradient(weights, gradient);

  EXPECT_NEAR(error, json.at("E").get<double>(), 1e-6);
  for (std::size_t k = 0; k < wanted.size(); ++k) EXPECT_NEAR(gradient[k], wanted[k], 1e-6) << k;
}

TEST(ReadNetworkJson, NetworkFixture_OutputsWithin1e6) {
  RecordProperty("requirement", "CLS-1");
  std::ifstream file(reference("nn_fixture.json"));
  if (!file) GTEST_SKIP() << "the reference data are not here";
  const auto json = nlohmann::json::parse(file);
  const auto foreign = read_network_json(reference("nn_fixture.json").string());
  ASSERT_TRUE(foreign) << core::to_string(foreign.error());
  ASSERT_EQ(foreign->inputs.size(), 5U);

  for (const auto& example : json.at("examples")) {
    const std::vector<double> features = example.at("x");
    std::vector<double> scaled;
    for (std::size_t k = 0; k < features.size(); ++k) scaled.push_back(foreign->inputs[k].scaled(features[k]));
    const auto outputs = foreign->networks.front().outputs(scaled);
    const std::vector<double> wanted = example.at("out");
    for (std::size_t k = 0; k < wanted.size(); ++k) EXPECT_NEAR(outputs[k], wanted[k], 1e-6);
  }
}

TEST(Minimise, CurvedValley_FindsItsFloor) {
  const Objective valley{
      .error = [](std::span<const double> w) { return std::pow(1.0 - w[0], 2) + 100.0 * std::pow(w[1] - w[0] * w[0], 2); },
      .gradient =
          [](std::span<const double> w, std::span<double> out) {
            out[0] = -2.0 * (1.0 - w[0]) - 400.0 * w[0] * (w[1] - w[0] * w[0]);
            out[1] = 200.0 * (w[1] - w[0] * w[0]);
            return std::pow(1.0 - w[0], 2) + 100.0 * std::pow(w[1] - w[0] * w[0], 2);
          }};

  const auto minimum = minimise(valley, {-1.2, 1.0}, {}, {});

  EXPECT_NEAR(minimum.weights[0], 1.0, 1e-4);
  EXPECT_NEAR(minimum.weights[1], 1.0, 1e-4);
  EXPECT_LT(minimum.epochs, 1000);
}

TEST(Minimise, ValidationThatGetsWorse_StopsAfterSixAndKeepsTheBest) {
  const Objective slope{.error = [](std::span<const double> w) { return w[0] * w[0]; },
                        .gradient =
                            [](std::span<const double> w, std::span<double> out) {
                              out[0] = 2.0 * w[0];
                              return w[0] * w[0];
                            }};
  int asked = 0;

  const auto minimum = minimise(slope, {5.0}, [&](std::span<const double>) { return asked++; }, {.least_gradient = -1.0});

  EXPECT_EQ(minimum.epochs, 6);
  EXPECT_EQ(minimum.weights[0], 5.0);
}

}  // namespace
}  // namespace dts::lab::training
