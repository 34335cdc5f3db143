// SPDX-License-Identifier: Apache-2.0
#include "accuracy/low_pass.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dts::accuracy {
namespace {

constexpr double kCutHz = 10.0;
constexpr std::size_t kPaddingSamples = 15;  // 3 x (order + 1), as scipy: part of the definition of the profile

/// In place, from the steady state of the first sample.
void run(const Section& section, std::vector<double>& samples) {
  const double first = samples.front();
  double late = (section.b2 - section.a2) * first;
  double soon = (section.b1 - section.a1) * first + late;
  for (double& sample : samples) {
    const double in = sample;
    sample = section.b0 * in + soon;
    soon = section.b1 * in - section.a1 * sample + late;
    late = section.b2 * in - section.a2 * sample;
  }
}

std::vector<double> padded(std::span<const double> samples) {
  std::vector<double> result;
  result.reserve(samples.size() + 2 * kPaddingSamples);
  for (std::size_t i = kPaddingSamples; i > 0; --i) result.push_back(2.0 * samples.front() - samples[i]);
  result.insert(result.end(), samples.begin(), samples.end());
  for (std::size_t i = 1; i <= kPaddingSamples; ++i) result.push_back(2.0 * samples.back() - samples[samples.size() - 1 - i]);
  return result;
}

}  // namespace

std::array<Section, 2> butterworth4(double cut_hz, double rate_hz) {
  const double k = std::tan(std::numbers::pi * cut_hz / rate_hz);
  std::array<Section, 2> sections{};
  for (std::size_t pair = 0; pair < sections.size(); ++pair) {
    // Poles of the prototype stand at pi/8 and 3 pi/8 from the negative real axis; damping is twice the cosine.
    const double damping = 2.0 * std::cos(std::numbers::pi * (2.0 * static_cast<double>(pair) + 1.0) / 8.0);
    const double scale = 1.0 / (1.0 + damping * k + k * k);
    const double b0 = k * k * scale;
    sections[pair] = {b0, 2.0 * b0, b0, 2.0 * (k * k - 1.0) * scale, (1.0 - damping * k + k * k) * scale};
  }
  return sections;
}

std::vector<double> lp10(std::span<const double> samples, double rate_hz) {
  if (samples.size() <= kPaddingSamples) return {};
  const auto sections = butterworth4(kCutHz, rate_hz);
  std::vector<double> work = padded(samples);
  for (int direction = 0; direction < 2; ++direction) {
    for (const Section& section : sections) run(section, work);
    std::ranges::reverse(work);
  }
  return {work.begin() + kPaddingSamples, work.end() - kPaddingSamples};
}

std::vector<double> every_nth(std::span<const double> samples, std::size_t step) {
  std::vector<double> result;
  for (std::size_t i = 0; i < samples.size(); i += step) result.push_back(samples[i]);
  return result;
}

}  // namespace dts::accuracy
