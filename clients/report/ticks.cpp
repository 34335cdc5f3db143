// SPDX-License-Identifier: Apache-2.0
#include "report/ticks.h"

#include <algorithm>
#include <cmath>

#include "report/number_text.h"

namespace dts::report {

std::string Ticks::label(double value) const { return fixed(value, decimals); }

Ticks round_ticks(double low, double high, std::size_t most) {
  const double least_step = (high - low) / static_cast<double>(std::max<std::size_t>(most, 1));
  if (!std::isfinite(least_step) || !(least_step > 0.0)) return {};
  int exponent = static_cast<int>(std::floor(std::log10(least_step)));
  double factor = 10.0;
  for (const double candidate : {1.0, 2.0, 5.0}) {
    if (candidate * std::pow(10.0, exponent) >= least_step * (1.0 - 1e-9)) {
      factor = candidate;
      break;
    }
  }
  if (factor == 10.0) {
    factor = 1.0;
    ++exponent;
  }
  Ticks ticks{.step = factor * std::pow(10.0, exponent), .decimals = std::max(0, -exponent)};
  const double first = std::ceil(low / ticks.step - 1e-9);
  for (double index = first; index * ticks.step <= high + 1e-9 * ticks.step && ticks.at.size() <= 2 * most; index += 1.0) {
    ticks.at.push_back(index * ticks.step);
  }
  return ticks;
}

}  // namespace dts::report
