// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "classifier/network.h"
#include "classifier/reach_feature.h"
#include "core/result.h"

namespace dts::lab::training {

/// Networks that came from elsewhere.
struct ForeignNetworks {
  std::vector<classifier::Network> networks;
  std::vector<classifier::FeatureRange> inputs;  ///< How they scale; empty: not said.
};

/// Weights of one layer as others write them: rows are outputs.
struct Layer {
  std::size_t outputs = 0;
  std::size_t inputs = 0;
  std::vector<double> weights;
  std::vector<double> biases;
};

/// Fails with InvalidArgument when the layers do not follow each other or do not end in three outputs.
[[nodiscard]] core::Result<classifier::Network> network_of(const Layer& hidden, const Layer& output, classifier::OutputKind kind);

/// One network as JSON: "layers" [5, 8, 3], "hidden" "tanh", "output" "logistic" or "softmax", "W1" "b1" "W2" "b2", and, if it scales its
/// inputs, "input" (names), "lo", "hi". Fails with InvalidArgument, naming the file and the key.
[[nodiscard]] core::Result<ForeignNetworks> read_network_json(const std::string& file);

}  // namespace dts::lab::training
