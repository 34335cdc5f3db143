// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/steady.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "cli/table.h"

namespace dts::ctl {
namespace {

constexpr std::size_t kQuarters = 4;
constexpr double kDependentScans = 3.0;  // because of the thesis's window filter
constexpr double kDeviations = 4.0;      // at rest the range of five means exceeds this in about 4 % of windows

}  // namespace

SteadyDetector::SteadyDetector(std::size_t channel_count, const SteadyLimits& limits)
    : limits_(limits), ring_(channel_count, std::vector<double>(ring_scans())) {}

void SteadyDetector::add(std::span<const double> scan) {
  if (std::ranges::any_of(scan, [](double value) { return !std::isfinite(value); })) return reset();
  for (std::size_t channel = 0; channel < ring_.size(); ++channel) ring_[channel][count_ % ring_scans()] = scan[channel];
  ++count_;
}

void SteadyDetector::reset() noexcept { count_ = 0; }

SteadyDetector::Estimate SteadyDetector::estimate_of(std::size_t channel) const {
  const std::size_t window = limits_.window_scans;
  const std::size_t lead = ring_scans() - window;
  const auto value = [&](std::size_t age) { return ring_[channel][(count_ + age) % ring_scans()]; };  // age 0 is the oldest
  const auto mean = [&](std::size_t first, std::size_t end) {
    double sum = 0.0;
    for (std::size_t i = first; i < end; ++i) sum += value(i);
    return sum / static_cast<double>(end - first);
  };
  std::array<double, kQuarters + 1> means{};
  std::array<double, kQuarters> noises{};
  means[kQuarters] = mean(0, lead);
  Estimate estimate;
  estimate.mean = mean(lead, lead + window);
  for (std::size_t quarter = 0; quarter < kQuarters; ++quarter) {
    const std::size_t first = lead + quarter * window / kQuarters;
    const std::size_t end = lead + (quarter + 1) * window / kQuarters;
    means[quarter] = mean(first, end);
    double squares = 0.0;
    for (std::size_t i = first; i < end; ++i) squares += std::pow(value(i) - means[quarter], 2);
    noises[quarter] = std::sqrt(squares / static_cast<double>(end - first - 1));
  }
  std::ranges::sort(noises);
  estimate.noise = 0.5 * (noises[1] + noises[2]);
  const auto [low, high] = std::ranges::minmax(means);
  estimate.drift = high - low;
  const double independent = std::max(1.0, static_cast<double>(window) / static_cast<double>(kQuarters) / kDependentScans);
  estimate.drift_limit = limits_.drift + kDeviations * estimate.noise / std::sqrt(independent);
  return estimate;
}

std::optional<SteadyReading> SteadyDetector::reading() const {
  if (!is_full()) return std::nullopt;
  SteadyReading reading{.mean = {}, .noise = {}, .scans = limits_.window_scans};
  for (std::size_t channel = 0; channel < ring_.size(); ++channel) {
    const Estimate estimate = estimate_of(channel);
    if (!rests(estimate)) return std::nullopt;
    reading.mean.push_back(estimate.mean);
    reading.noise.push_back(estimate.noise);
  }
  return reading;
}

std::optional<SteadyDetector::Unrest> SteadyDetector::unrest() const {
  if (!is_full()) return std::nullopt;
  std::optional<Unrest> worst;
  double worst_part = 1.0;
  for (std::size_t channel = 0; channel < ring_.size(); ++channel) {
    const Estimate estimate = estimate_of(channel);
    const double noise_part = estimate.noise / limits_.noise;
    const double drift_part = estimate.drift / estimate.drift_limit;
    if (std::max(noise_part, drift_part) <= worst_part) continue;
    worst_part = std::max(noise_part, drift_part);
    worst = Unrest{channel, noise_part > drift_part ? "varies by " + cli::decimal(estimate.noise, 4) + " rms"
                                                    : "drifts by " + cli::decimal(estimate.drift, 4)};
  }
  return worst;
}

}  // namespace dts::ctl
