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
  std::size_t hidden = 8;  ///< 6 to 12 make no difference (reach-model section 6).
  classifier::OutputKind output = classifier::OutputKind::Logistic;
  double decay = 0.0;
  StopRules stop{};
};

struct TrainedNetwork {
  classifier::Network network;
  double validation_accuracy = 0.0;  ///< Of the 15 % that only stopped the training.
  double test_accuracy = 0.0;        ///< Of the 15 % that it never saw.
  int epochs = 0;
};

/// First weights by Nguyen and Widrow (1990): each hidden node bends in a part of the inputs' range of its own.
[[nodiscard]] std::vector<double> first_weights(std::size_t inputs, std::size_t hidden, Random& random);

/// One training: random 70/15/15 split, best-validation weights. Fails when there are fewer than 20 rows.
[[nodiscard]] core::Result<TrainedNetwork> train_network(const Batch& batch, const NetworkOptions& options, std::uint64_t seed);

/// `count` networks of different seeds. A training that ends below `least_validation_accuracy` (some say one class whatever they see) is
/// repeated with another seed, at most four times per network in all; then it fails.
[[nodiscard]] core::Result<std::vector<TrainedNetwork>> train_networks(const Batch& batch, const NetworkOptions& options,
                                                                       std::uint64_t seed, std::size_t count,
                                                                       double least_validation_accuracy);

}  // namespace dts::lab::training
