// SPDX-License-Identifier: Apache-2.0
#include "lab/resolution/detection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lab/training/random.h"

namespace dts::lab::resolution {
namespace {

constexpr double kError = 0.05;             ///< Of each kind.
constexpr double kMissDeviations = 1.6449;  ///< What a standard normal variable exceeds with kError.
constexpr double kLeastDeviation = 1e-12;   ///< Values without any scatter.
constexpr int kDraws = 200;
constexpr double kBeyond = std::numeric_limits<double>::infinity();

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};

Moments moments_of(std::span<const double> values) {
  Moments moments;
  for (const double value : values) moments.mean += value / static_cast<double>(values.size());
  for (const double value : values) moments.variance += (value - moments.mean) * (value - moments.mean);
  moments.variance /= std::max(1.0, static_cast<double>(values.size()) - 1.0);
  return moments;
}

/// Returns the value that a standard normal variable exceeds with this probability (0 to 0.5), by bisection.
double exceeded_with(double probability) {
  double lower = 0.0;
  double upper = 8.0;
  for (int step = 0; step < 60; ++step) {
    const double middle = (lower + upper) / 2.0;
    (0.5 * std::erfc(middle / std::numbers::sqrt2) > probability ? lower : upper) = middle;
  }
  return lower;
}

/// Returns by how many standard deviations the mean difference at a level is above what the decision needs; negative: it is below.
double excess_of(const Moments& none, const Moments& moved, double reaches, double alarm_deviations) {
  const double deviation = std::sqrt((none.variance + moved.variance) / reaches);
  const double threshold = alarm_deviations * std::sqrt(2.0 * none.variance / reaches);
  const double difference = moved.mean - none.mean - threshold;
  return difference / std::max(deviation, kLeastDeviation) - kMissDeviations;
}

/// Returns the excess of the best series; `level` empty: without movement.
double best_excess(std::span<const Series> series, std::optional<std::size_t> level, int reaches, double alarm_deviations) {
  double best = -kBeyond;
  for (const Series& one : series) {
    const Moments none = moments_of(one.none);
    const Moments moved = level ? moments_of(one.levels[*level].values) : none;
    best = std::max(best, excess_of(none, moved, reaches, alarm_deviations));
  }
  return best;
}

std::vector<double> drawn(std::span<const double> values, training::Random& random) {
  std::vector<double> result;
  for (std::size_t k = 0; k < values.size(); ++k) result.push_back(values[random.index(values.size())]);
  return result;
}

/// Returns the middle 95 % of `limits`.
LimitInterval interval_of(Limit value, const std::vector<Limit>& limits) {
  return {.value = value, .lowest = quantile(limits, 0.025), .highest = quantile(limits, 0.975)};
}

}  // namespace

Limit detection_limit(std::span<const Series> series, int reaches) {
  if (series.empty()) return std::nullopt;
  double last_deg = 0.0;
  const double alarm_deviations = exceeded_with(kError / static_cast<double>(series.size()));
  double last_excess = best_excess(series, std::nullopt, reaches, alarm_deviations);
  Limit limit;
  for (std::size_t k = 0; k < series.front().levels.size(); ++k) {
    const double turn_deg = series.front().levels[k].turn_deg;
    const double excess = best_excess(series, k, reaches, alarm_deviations);
    if (excess < 0.0) {
      limit.reset();
    } else if (!limit) {
      limit = last_deg + (turn_deg - last_deg) * -last_excess / (excess - last_excess);
    }
    last_deg = turn_deg;
    last_excess = excess;
  }
  return limit;
}

LimitInterval with_interval(std::span<const Series> series, int reaches, std::uint64_t seed) {
  training::Random random(seed);
  std::vector<Limit> limits;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<Series> again;
    for (const Series& one : series) {
      Series& copy = again.emplace_back();
      copy.none = drawn(one.none, random);
      for (const Level& level : one.levels) copy.levels.push_back({level.turn_deg, drawn(level.values, random)});
    }
    limits.push_back(detection_limit(again, reaches));
  }
  return interval_of(detection_limit(series, reaches), limits);
}

Limit quantile(std::vector<Limit> limits, double part) {
  if (limits.empty()) return std::nullopt;
  std::ranges::sort(limits, {}, [](const Limit& limit) { return limit.value_or(kBeyond); });
  const double place = part * static_cast<double>(limits.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const Limit lower = limits[below];
  const Limit upper = limits[std::min(below + 1, limits.size() - 1)];
  const double share = place - static_cast<double>(below);
  if (share == 0.0 || !lower) return lower;
  return upper ? Limit(*lower + share * (*upper - *lower)) : std::nullopt;
}

LimitInterval median_over_people(const std::vector<Limit>& limits, std::uint64_t seed) {
  training::Random random(seed);
  std::vector<Limit> medians;
  for (int draw = 0; draw < kDraws && !limits.empty(); ++draw) {
    std::vector<Limit> people;
    for (std::size_t k = 0; k < limits.size(); ++k) people.push_back(limits[random.index(limits.size())]);
    medians.push_back(quantile(std::move(people), 0.5));
  }
  return interval_of(quantile(limits, 0.5), medians);
}

}  // namespace dts::lab::resolution
