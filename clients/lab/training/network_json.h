// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "classifier/network.h"
#include "classifier/reach_feature.h"
#include "core/result.h"

namespace dts::lab::training {

/// Networks from another program.
struct ForeignNetworks {
  std::vector<classifier::Network> networks;
  std::vector<classifier::FeatureRange> inputs;  ///< Their scaling; empty: not specified.
};

/// Weights of one layer in the usual order of other programs: rows are outputs.
struct Layer {
  std::size_t outputs = 0;
  std::size_t inputs = 0;
  std::vector<double> weights;
  std::vector<double> biases;
};

/// Fails with InvalidArgument if the sizes of the layers do not match or the last one does not have three outputs.
[[nodiscard]] core::Result<classifier::Network> network_of(const Layer& hidden, const Layer& output, classifier::OutputKind kind);

/// Reads one network as JSON: "layers" [5, 8, 3], "hidden" "tanh", "output" "logistic" or "softmax", "W1" "b1" "W2" "b2", and, if it scales
/// its inputs, "input" (names), "lo", "hi". Fails with InvalidArgument, naming the file and the key.
[[nodiscard]] core::Result<ForeignNetworks> read_network_json(const std::string& file);

}  // namespace dts::lab::training
