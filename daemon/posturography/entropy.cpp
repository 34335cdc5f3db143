// SPDX-License-Identifier: Apache-2.0
#include "posturography/entropy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

namespace dts::posturography {
namespace {

constexpr std::size_t kChunk = 256;  // number of distances processed together

double population_sd(std::span<const double> values) {
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / count);
}

/// columns[d][i]: value d of the i-th template, in the order of their first values.
std::vector<std::vector<double>> sorted_templates(std::span<const double> values, std::size_t m) {
  std::vector<std::uint32_t> order(values.size() - m);
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::uint32_t start) { return values[start]; });
  std::vector<std::vector<double>> columns(m + 1, std::vector<double>(order.size()));
  for (std::size_t d = 0; d <= m; ++d) {
    for (std::size_t i = 0; i < order.size(); ++i) columns[d][i] = values[order[i] + d];
  }
  return columns;
}

struct Matches {
  std::uint64_t of_m = 0;
  std::uint64_t of_m_plus_1 = 0;
};

std::uint64_t within(std::span<const double> distances, double tolerance) noexcept {
  std::uint64_t count = 0;
  for (const double distance : distances) count += distance <= tolerance ? 1U : 0U;
  return count;
}

void widen(std::span<double> distances, const double* others, double value) noexcept {
  for (std::size_t j = 0; j < distances.size(); ++j) {
    const double distance = std::abs(others[j] - value);
    distances[j] = distance > distances[j] ? distance : distances[j];
  }
}

/// Counts matches of template `i` with the templates at [first, last), whose first values are all near enough. Plain loops over chunks, so
/// that the compiler vectorises them.
void count_matches(const std::vector<std::vector<double>>& columns, std::size_t i, std::size_t first, std::size_t last, double tolerance,
                   Matches& matches) noexcept {
  std::array<double, kChunk> chunk;
  const std::size_t m = columns.size() - 1;
  for (; first < last; first += kChunk) {
    const std::span<double> distances(chunk.data(), std::min(kChunk, last - first));
    std::ranges::fill(distances, 0.0);
    for (std::size_t d = 1; d < m; ++d) widen(distances, columns[d].data() + first, columns[d][i]);
    matches.of_m += within(distances, tolerance);
    widen(distances, columns[m].data() + first, columns[m][i]);
    matches.of_m_plus_1 += within(distances, tolerance);
  }
}

}  // namespace

std::optional<double> sample_entropy(std::span<const double> values, std::size_t m, double r) {
  if (m == 0 || values.size() < 2 || m >= values.size() - 1) return std::nullopt;
  const double tolerance = r * population_sd(values);
  const auto [least, most] = std::ranges::minmax(values);
  if (!std::isfinite(tolerance) || tolerance < 0.0 || least == most) return std::nullopt;
  const std::vector<std::vector<double>> columns = sorted_templates(values, m);
  const std::vector<double>& firsts = columns.front();
  Matches matches;
  std::size_t end = 0;
  for (std::size_t i = 0; i < firsts.size(); ++i) {
    // Rounding keeps the order: if one difference is too large, all later ones are too.
    end = std::max(end, i + 1);
    while (end < firsts.size() && firsts[end] - firsts[i] <= tolerance) ++end;
    count_matches(columns, i, i + 1, end, tolerance, matches);
  }
  if (matches.of_m == 0 || matches.of_m_plus_1 == 0) return std::nullopt;
  return 0.0 - std::log(static_cast<double>(matches.of_m_plus_1) / static_cast<double>(matches.of_m));  // 0.0 -: avoids -0
}

}  // namespace dts::posturography
