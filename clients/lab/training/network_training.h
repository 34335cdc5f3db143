// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "classifier/network.h"
#include "core/result.h"
#include "lab/training/conjugate_gradient.h"
#include "lab/training/error_gradient.h"
#include "lab/training/random.h"

namespace dts::lab::training {

struct NetworkOptions {
  std::size_t hidden = 8;  ///< 6 to 12 give the same result (reach-model section 6).
  classifier::OutputKind output = classifier::OutputKind::Logistic;
  double decay = 0.0;
  StopRules stop{};
};

struct TrainedNetwork {
  classifier::Network network;
  double validation_accuracy = 0.0;  ///< On the 15 % that are used only to stop the training.
  double test_accuracy = 0.0;        ///< On the 15 % that the training never uses.
  int epochs = 0;
};

/// Returns initial weights by Nguyen and Widrow (1990): each hidden node covers its own part of the input range.
[[nodiscard]] std::vector<double> first_weights(std::size_t inputs, std::size_t hidden, Random& random);

/// Trains one network: random 70/15/15 split, weights with the best validation error. Fails if there are fewer than 20 rows.
[[nodiscard]] core::Result<TrainedNetwork> train_network(const Batch& batch, const NetworkOptions& options, std::uint64_t seed);

/// Trains `count` networks with different seeds. Repeats a training that ends below `least_validation_accuracy` (some networks always
/// answer the same class) with another seed, at most four times per network in total; then fails.
[[nodiscard]] core::Result<std::vector<TrainedNetwork>> train_networks(const Batch& batch, const NetworkOptions& options,
                                                                       std::uint64_t seed, std::size_t count,
                                                                       double least_validation_accuracy);

}  // namespace dts::lab::training
