// SPDX-License-Identifier: Apache-2.0
#include "lab/training/network_training.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

namespace dts::lab::training {
namespace {

using classifier::kClasses;
using classifier::Network;

constexpr std::size_t kLeastRows = 20;
constexpr std::size_t kTriesPerNetwork = 4;

double accuracy(const Network& network, const Batch& batch) {
  std::size_t right = 0;
  for (std::size_t k = 0; k < batch.size(); ++k) {
    const auto outputs = network.outputs(batch.row(k));
    const auto best = static_cast<std::size_t>(std::max_element(outputs.begin(), outputs.end()) - outputs.begin());
    right += best == batch.classes[k] ? 1 : 0;
  }
  return static_cast<double>(right) / static_cast<double>(batch.size());
}

}  // namespace

std::vector<double> first_weights(std::size_t inputs, std::size_t hidden, Random& random) {
  std::vector<double> weights(Network::weight_count(inputs, hidden));
  const double length = 0.7 * std::pow(static_cast<double>(hidden), 1.0 / static_cast<double>(inputs));
  for (std::size_t node = 0; node < hidden; ++node) {
    const std::span row = std::span(weights).subspan(node * inputs, inputs);
    double square = 0.0;
    for (double& weight : row) {
      weight = random.uniform(-1.0, 1.0);
      square += weight * weight;
    }
    for (double& weight : row) weight *= length / std::sqrt(square);
    const double place = hidden == 1 ? 0.0 : 2.0 * static_cast<double>(node) / static_cast<double>(hidden - 1) - 1.0;
    weights[hidden * inputs + node] = length * place * (row.front() < 0.0 ? -1.0 : 1.0);
  }
  for (std::size_t k = hidden * (inputs + 1); k < weights.size(); ++k) weights[k] = random.uniform(-0.5, 0.5);
  return weights;
}

core::Result<TrainedNetwork> train_network(const Batch& batch, const NetworkOptions& options, std::uint64_t seed) {
  if (batch.size() < kLeastRows) {
    return core::fail(core::ErrorCode::InvalidArgument,
                      "training: " + std::to_string(batch.size()) + " reaches of class 1 to 3 are too few",
                      "use at least " + std::to_string(kLeastRows) + " reaches of several healthy people");
  }
  Random random(seed);
  const auto order = random.shuffled(batch.size());
  const std::size_t held_out = batch.size() * 15 / 100;
  const auto all = std::span(order);
  const Batch validation = batch.part(all.first(held_out));
  const Batch test = batch.part(all.subspan(held_out, held_out));
  const Batch training = batch.part(all.subspan(2 * held_out));
  const NetworkError training_error(training, options.hidden, options.output, options.decay);
  const NetworkError validation_error(validation, options.hidden, options.output);
  const Objective objective{
      .error = [&](std::span<const double> weights) { return training_error.error(weights); },
      .gradient = [&](std::span<const double> weights, std::span<double> out) { return training_error.gradient(weights, out); }};
  auto minimum = minimise(
      objective, first_weights(batch.input_count, options.hidden, random),
      [&](std::span<const double> weights) { return validation_error.error(weights); }, options.stop);
  DTS_TRY_ASSIGN(auto network, Network::create(batch.input_count, options.hidden, options.output, std::move(minimum.weights)));
  TrainedNetwork result{.network = std::move(network), .epochs = minimum.epochs};
  result.validation_accuracy = accuracy(result.network, validation);
  result.test_accuracy = accuracy(result.network, test);
  return result;
}

core::Result<std::vector<TrainedNetwork>> train_networks(const Batch& batch, const NetworkOptions& options, std::uint64_t seed,
                                                         std::size_t count, double least_validation_accuracy) {
  std::vector<TrainedNetwork> networks;
  double best = 0.0;
  for (std::size_t attempt = 0; attempt < kTriesPerNetwork * count && networks.size() < count; ++attempt) {
    DTS_TRY_ASSIGN(auto trained, train_network(batch, options, derived_seed(seed, attempt)));
    best = std::max(best, trained.validation_accuracy);
    if (trained.validation_accuracy >= least_validation_accuracy) networks.push_back(std::move(trained));
  }
  if (networks.size() == count) return networks;
  return core::fail(core::ErrorCode::Failed,
                    "training: only " + std::to_string(networks.size()) + " of " + std::to_string(kTriesPerNetwork * count) +
                        " networks could be trained; the best was correct for " + std::to_string(static_cast<int>(100.0 * best)) +
                        " % of its validation reaches",
                    "check that the conditions of the trials are the targets that the people reached for");
}

}  // namespace dts::lab::training
