// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dts::bench {

/// Collects durations; memory is taken beforehand, so that adding up to `expected` of them does not allocate.
class Percentiles {
 public:
  explicit Percentiles(std::size_t expected) { values_us_.reserve(expected); }

  void add_ns(std::int64_t value_ns) { values_us_.push_back(static_cast<double>(value_ns) * 1e-3); }
  void sort() { std::ranges::sort(values_us_); }
  /// The value below which the fraction `q` of all lies, us; 0 when there are none. `sort` first.
  [[nodiscard]] double us(double q) const {
    if (values_us_.empty()) return 0.0;
    const auto index = static_cast<std::size_t>(q * static_cast<double>(values_us_.size()));
    return values_us_[std::min(index, values_us_.size() - 1)];
  }
  [[nodiscard]] std::size_t size() const noexcept { return values_us_.size(); }

 private:
  std::vector<double> values_us_;
};

}  // namespace dts::bench
