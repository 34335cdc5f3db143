// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace dts::physics {

/// Polynomials of total degree 5 in (u, v), four of them evaluated together: with the outputs of one term next to each other, the compiler
/// keeps them in vector registers.
struct Quintic {
  static constexpr std::size_t kDegree = 5;
  static constexpr std::size_t kTermCount = (kDegree + 1) * (kDegree + 2) / 2;
  using Outputs = std::array<double, 4>;

  /// Coefficients of u^i v^j at `index(i, j)`.
  std::array<Outputs, kTermCount> coefficients{};

  /// Returns the index of u^i v^j, i + j <= 5: rows of equal i, each in rising j.
  [[nodiscard]] static constexpr std::size_t index(std::size_t i, std::size_t j) noexcept {
    return i * (kDegree + 1) - (i == 0 ? 0 : i * (i - 1) / 2) + j;
  }

  /// Evaluates by Horner's scheme, in v within each row and in u over the rows. Realtime-safe: yes.
  [[nodiscard]] Outputs operator()(double u, double v) const noexcept {
    Outputs total{};
    for (std::size_t i = kDegree + 1; i-- > 0;) {
      Outputs row{};
      for (std::size_t j = kDegree - i + 1; j-- > 0;) {
        const Outputs& coefficient = coefficients[index(i, j)];
        for (std::size_t k = 0; k < row.size(); ++k) row[k] = row[k] * v + coefficient[k];
      }
      for (std::size_t k = 0; k < row.size(); ++k) total[k] = total[k] * u + row[k];
    }
    return total;
  }

  friend bool operator==(const Quintic&, const Quintic&) = default;
};

}  // namespace dts::physics
