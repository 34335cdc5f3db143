// SPDX-License-Identifier: Apache-2.0
#include "classifier/network.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace dts::classifier {
namespace {

/// Cannot overflow: exp is called only with values <= 0.
double logistic(double sum) noexcept {
  if (sum >= 0.0) return 1.0 / (1.0 + std::exp(-sum));
  const double power = std::exp(sum);
  return power / (1.0 + power);
}

}  // namespace

Network::Outputs activate(OutputKind output, const Network::Outputs& sums) noexcept {
  Network::Outputs result{};
  if (output == OutputKind::Logistic) {
    std::transform(sums.begin(), sums.end(), result.begin(), logistic);
    return result;
  }
  const double largest = *std::max_element(sums.begin(), sums.end());
  double total = 0.0;
  for (std::size_t k = 0; k < kClasses; ++k) total += result[k] = std::exp(sums[k] - largest);
  for (double& value : result) value /= total;
  return result;
}

core::Result<Network> Network::create(std::size_t inputs, std::size_t hidden, OutputKind output, std::vector<double> weights) {
  const auto wrong = [](const std::string& what) {
    return core::fail(core::ErrorCode::InvalidArgument, "network: " + what,
                      "use a network with 1 to " + std::to_string(kMaxInputs) + " inputs, 1 to " + std::to_string(kMaxHidden) +
                          " hidden nodes and 3 outputs");
  };
  if (inputs < 1 || inputs > kMaxInputs) return wrong(std::to_string(inputs) + " inputs");
  if (hidden < 1 || hidden > kMaxHidden) return wrong(std::to_string(hidden) + " hidden nodes");
  if (output != OutputKind::Logistic && output != OutputKind::Softmax) return wrong("its kind of output is unknown");
  if (weights.size() != weight_count(inputs, hidden)) {
    return wrong(std::to_string(weights.size()) + " weights instead of " + std::to_string(weight_count(inputs, hidden)));
  }
  if (!std::all_of(weights.begin(), weights.end(), [](double weight) { return std::isfinite(weight); })) {
    return wrong("a weight is not finite");
  }
  return Network(inputs, hidden, output, std::move(weights));
}

Network::Outputs Network::outputs(std::span<const double> scaled) const noexcept {
  std::array<double, kMaxHidden> hidden{};
  const double* weight = weights_.data();
  for (std::size_t node = 0; node < hidden_; ++node) {
    for (std::size_t input = 0; input < inputs_; ++input) hidden[node] += *weight++ * scaled[input];
  }
  for (std::size_t node = 0; node < hidden_; ++node) hidden[node] = std::tanh(hidden[node] + *weight++);
  Outputs sums{};
  for (double& sum : sums) {
    for (std::size_t node = 0; node < hidden_; ++node) sum += *weight++ * hidden[node];
  }
  for (double& sum : sums) sum += *weight++;
  return activate(output_, sums);
}

}  // namespace dts::classifier
