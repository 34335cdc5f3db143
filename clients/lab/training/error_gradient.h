// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "classifier/network.h"

namespace dts::lab::training {

/// Rows of scaled inputs, each with its class.
struct Batch {
  std::size_t input_count = 0;
  std::vector<double> inputs;        ///< Row by row.
  std::vector<std::size_t> classes;  ///< 0, 1, 2.

  [[nodiscard]] std::size_t size() const noexcept { return classes.size(); }
  [[nodiscard]] std::span<const double> row(std::size_t index) const { return std::span(inputs).subspan(index * input_count, input_count); }
  /// Returns the rows with these indices.
  [[nodiscard]] Batch part(std::span<const std::size_t> rows) const;
};

/// The error that training minimises. Logistic outputs: the mean over all rows and outputs of (y - t)^2 with t 1 or 0. Softmax: the mean
/// cross-entropy per row. Plus `decay` times the mean square of the weights.
class NetworkError {
 public:
  NetworkError(const Batch& batch, std::size_t hidden, classifier::OutputKind output, double decay = 0.0)
      : batch_(batch), hidden_(hidden), output_(output), decay_(decay) {}

  [[nodiscard]] double error(std::span<const double> weights) const;
  /// Computes the error and, by backpropagation, its gradient; `gradient` must have as many values as `weights`.
  double gradient(std::span<const double> weights, std::span<double> gradient) const;

 private:
  using Hidden = std::array<double, classifier::Network::kMaxHidden>;

  classifier::Network::Outputs forward(std::span<const double> weights, std::span<const double> row, Hidden& hidden) const;
  double row_error(const classifier::Network::Outputs& outputs, std::size_t wanted) const;
  double decay_error(std::span<const double> weights) const;

  const Batch& batch_;
  std::size_t hidden_;
  classifier::OutputKind output_;
  double decay_;
};

}  // namespace dts::lab::training
