// SPDX-License-Identifier: Apache-2.0
#include "lab/training/error_gradient.h"

#include <algorithm>
#include <cmath>

namespace dts::lab::training {

using classifier::kClasses;
using classifier::OutputKind;
using Outputs = classifier::Network::Outputs;

Batch Batch::part(std::span<const std::size_t> rows) const {
  Batch result{.input_count = input_count, .inputs = {}, .classes = {}};
  for (const std::size_t index : rows) {
    const auto values = row(index);
    result.inputs.insert(result.inputs.end(), values.begin(), values.end());
    result.classes.push_back(classes[index]);
  }
  return result;
}

Outputs NetworkError::forward(std::span<const double> weights, std::span<const double> row, Hidden& hidden) const {
  const double* weight = weights.data();
  for (std::size_t node = 0; node < hidden_; ++node) {
    double sum = 0.0;
    for (const double input : row) sum += *weight++ * input;
    hidden[node] = sum;
  }
  for (std::size_t node = 0; node < hidden_; ++node) hidden[node] = std::tanh(hidden[node] + *weight++);
  Outputs sums{};
  for (double& sum : sums) {
    for (std::size_t node = 0; node < hidden_; ++node) sum += *weight++ * hidden[node];
  }
  for (double& sum : sums) sum += *weight++;
  return activate(output_, sums);
}

double NetworkError::row_error(const Outputs& outputs, std::size_t wanted) const {
  if (output_ == OutputKind::Softmax) return -std::log(std::max(outputs[wanted], 1e-300));
  double sum = 0.0;
  for (std::size_t k = 0; k < kClasses; ++k) {
    const double difference = outputs[k] - (k == wanted ? 1.0 : 0.0);
    sum += difference * difference;
  }
  return sum / static_cast<double>(kClasses);
}

double NetworkError::decay_error(std::span<const double> weights) const {
  double sum = 0.0;
  for (const double weight : weights) sum += weight * weight;
  return decay_ * sum / static_cast<double>(weights.size());
}

double NetworkError::error(std::span<const double> weights) const {
  Hidden hidden{};
  double sum = 0.0;
  for (std::size_t k = 0; k < batch_.size(); ++k) sum += row_error(forward(weights, batch_.row(k), hidden), batch_.classes[k]);
  return sum / static_cast<double>(batch_.size()) + decay_error(weights);
}

double NetworkError::gradient(std::span<const double> weights, std::span<double> gradient) const {
  std::fill(gradient.begin(), gradient.end(), 0.0);
  const std::size_t inputs = batch_.input_count;
  const std::size_t second = hidden_ * (inputs + 1);  // first weight of the output layer
  const double by_row = 1.0 / static_cast<double>(batch_.size());
  Hidden hidden{};
  double sum = 0.0;
  for (std::size_t k = 0; k < batch_.size(); ++k) {
    const auto row = batch_.row(k);
    const Outputs outputs = forward(weights, row, hidden);
    sum += row_error(outputs, batch_.classes[k]);
    Hidden back{};
    for (std::size_t out = 0; out < kClasses; ++out) {
      double delta = (outputs[out] - (out == batch_.classes[k] ? 1.0 : 0.0)) * by_row;  // for softmax with cross-entropy
      if (output_ == OutputKind::Logistic) delta *= 2.0 / static_cast<double>(kClasses) * outputs[out] * (1.0 - outputs[out]);
      for (std::size_t node = 0; node < hidden_; ++node) {
        gradient[second + out * hidden_ + node] += delta * hidden[node];
        back[node] += delta * weights[second + out * hidden_ + node];
      }
      gradient[second + kClasses * hidden_ + out] += delta;
    }
    for (std::size_t node = 0; node < hidden_; ++node) {
      const double delta = back[node] * (1.0 - hidden[node] * hidden[node]);
      for (std::size_t input = 0; input < inputs; ++input) gradient[node * inputs + input] += delta * row[input];
      gradient[hidden_ * inputs + node] += delta;
    }
  }
  const double pull = 2.0 * decay_ / static_cast<double>(weights.size());
  for (std::size_t k = 0; k < weights.size(); ++k) gradient[k] += pull * weights[k];
  return sum * by_row + decay_error(weights);
}

}  // namespace dts::lab::training
