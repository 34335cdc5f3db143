// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"

namespace dts::classifier {

inline constexpr std::size_t kClasses = 3;

enum class OutputKind : std::uint8_t {
  Logistic = 1,  ///< Each class independently, as in the thesis.
  Softmax = 2,   ///< Outputs sum to 1.
};

/// A network of one hidden layer and three outputs (thesis 5.3.4: 5-8-3), with a tanh hidden layer. The caller scales the inputs to [-1,
/// 1]. Weights are flat: hidden x inputs row by row, hidden biases, 3 x hidden row by row, output biases.
class Network {
 public:
  static constexpr std::size_t kMaxInputs = 12;
  static constexpr std::size_t kMaxHidden = 32;
  using Outputs = std::array<double, kClasses>;

  /// Fails with InvalidArgument if a count is out of range or does not match the weights, or if a weight is not finite.
  [[nodiscard]] static core::Result<Network> create(std::size_t inputs, std::size_t hidden, OutputKind output, std::vector<double> weights);
  [[nodiscard]] static constexpr std::size_t weight_count(std::size_t inputs, std::size_t hidden) noexcept {
    return hidden * (inputs + 1) + kClasses * (hidden + 1);
  }

  /// `scaled` must have input_count() values. Realtime-safe: yes.
  [[nodiscard]] Outputs outputs(std::span<const double> scaled) const noexcept;

  [[nodiscard]] std::size_t input_count() const noexcept { return inputs_; }
  [[nodiscard]] std::size_t hidden_count() const noexcept { return hidden_; }
  [[nodiscard]] OutputKind output() const noexcept { return output_; }
  [[nodiscard]] const std::vector<double>& weights() const noexcept { return weights_; }

  friend bool operator==(const Network&, const Network&) = default;

 private:
  Network(std::size_t inputs, std::size_t hidden, OutputKind output, std::vector<double> weights)
      : inputs_(inputs), hidden_(hidden), output_(output), weights_(std::move(weights)) {}

  std::size_t inputs_;
  std::size_t hidden_;
  OutputKind output_;
  std::vector<double> weights_;
};

/// Applies the activation of the output layer to its sums.
[[nodiscard]] Network::Outputs activate(OutputKind output, const Network::Outputs& sums) noexcept;

}  // namespace dts::classifier
