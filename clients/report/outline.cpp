// SPDX-License-Identifier: Apache-2.0
#include "report/outline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "report/number_text.h"

namespace dts::report {
namespace {

constexpr std::size_t kKeptOfEach = 6;  // first, last, and two extremes of two columns

void keep_of(std::span<const double> first, std::span<const double> second, std::size_t begin, std::size_t end,
             std::vector<std::size_t>& kept) {
  std::array<std::size_t, kKeptOfEach> wanted{begin, end - 1, begin, begin, begin, begin};
  for (std::size_t index = begin; index < end; ++index) {
    if (first[index] < first[wanted[2]]) wanted[2] = index;
    if (first[index] > first[wanted[3]]) wanted[3] = index;
    if (second[index] < second[wanted[4]]) wanted[4] = index;
    if (second[index] > second[wanted[5]]) wanted[5] = index;
  }
  std::ranges::sort(wanted);
  const auto repeated = std::ranges::unique(wanted);
  kept.insert(kept.end(), wanted.begin(), repeated.begin());
}

std::string place(const PlotPoint& point) { return fixed(point.x, 2) + " " + fixed(point.y, 2); }

}  // namespace

std::vector<std::size_t> thinned(std::span<const double> first, std::span<const double> second, std::size_t most) {
  const std::size_t size = std::min(first.size(), second.size());
  const auto is_here = [&](std::size_t index) { return std::isfinite(first[index]) && std::isfinite(second[index]); };
  const std::size_t stretch = size <= most ? 1 : (size * kKeptOfEach + most - 1) / std::max<std::size_t>(most, 1);
  std::vector<std::size_t> kept;
  for (std::size_t index = 0; index < size;) {
    std::size_t end = index + 1;
    if (is_here(index)) {
      while (end < size && end - index < stretch && is_here(end)) ++end;
      keep_of(first, second, index, end, kept);
    } else {
      while (end < size && !is_here(end)) ++end;
      kept.push_back(index);
    }
    index = end;
  }
  if (kept.size() <= 4 * most) return kept;
  // A series with very many gaps: details cannot be seen anyway, but the page must stay small.
  const std::size_t every = (kept.size() + most - 1) / std::max<std::size_t>(most, 1);
  std::vector<std::size_t> few;
  for (std::size_t index = 0; index < kept.size(); index += every) few.push_back(kept[index]);
  return few;
}

std::string path_data(std::span<const PlotPoint> points) {
  std::string data;
  std::size_t in_line = 0;
  const auto close_lone = [&] {
    if (in_line == 1) data += "h0.01";
    in_line = 0;
  };
  for (const PlotPoint& point : points) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
      close_lone();
      continue;
    }
    data += in_line == 0 ? "M" : "L";
    data += place(point);
    ++in_line;
  }
  close_lone();
  return data;
}

std::vector<Gap> gaps_of(std::span<const double> values) {
  std::vector<Gap> gaps;
  for (std::size_t index = 0; index < values.size(); ++index) {
    if (std::isfinite(values[index])) continue;
    if (gaps.empty() || gaps.back().end != index) gaps.push_back({.begin = index, .end = index});
    gaps.back().end = index + 1;
  }
  return gaps;
}

}  // namespace dts::report
