// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace dts::report {

/// Round tick values of an axis: multiples of 1, 2 or 5 times a power of ten.
struct Ticks {
  double step = 1.0;
  int decimals = 0;  ///< Number of decimals that shows the ticks exactly.
  std::vector<double> at{};

  [[nodiscard]] std::string label(double value) const;
};
/// Returns at most `most` ticks within [low, high]; none if the range is empty or not finite.
[[nodiscard]] Ticks round_ticks(double low, double high, std::size_t most);

}  // namespace dts::report
