// SPDX-License-Identifier: Apache-2.0
#include "pipeline/reach/smoothness.h"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/special_numbers.h"

namespace dts::pipeline {
namespace {

constexpr double kHighestHz = 10.0;
constexpr double kLeastAmplitude = 0.05;
constexpr std::size_t kFrequencies = 101;  ///< Steps of 0.1 Hz, as fine as the zero-padded spectra in the literature.

/// Returns the magnitude of the Fourier sum of the transient's speed. Multiplies the rotation of one sample repeatedly, which is exact
/// enough for 1000 samples.
double amplitude(const TransientHistory& history, std::uint64_t first, std::uint64_t last, double radians) noexcept {
  const std::complex<double> turn = std::polar(1.0, -radians);
  std::complex<double> phase{1.0, 0.0};
  std::complex<double> sum{};
  for (std::uint64_t tick = first + 1; tick <= last; ++tick) {
    sum += std::abs(history.at(tick) - history.at(tick - 1)) * phase;
    phase = {phase.real() * turn.real() - phase.imag() * turn.imag(), phase.real() * turn.imag() + phase.imag() * turn.real()};
  }
  return std::abs(sum);
}

}  // namespace

double spectral_arc_length(const TransientHistory& history, std::uint64_t first, std::uint64_t last, double rate_hz) noexcept {
  first = std::max(first, history.oldest());
  if (last > history.now() || last < first + 4) return core::kNaN;
  std::array<double, kFrequencies> spectrum{};
  const double step_hz = kHighestHz / static_cast<double>(kFrequencies - 1);
  std::size_t highest = 0;
  for (std::size_t k = 0; k < kFrequencies; ++k) {
    spectrum[k] = amplitude(history, first, last, 2.0 * std::numbers::pi * static_cast<double>(k) * step_hz / rate_hz);
    if (!(spectrum[0] > 0.0)) return core::kNaN;
    if (k > 0) spectrum[k] /= spectrum[0];
    if (k > 0 && spectrum[k] >= kLeastAmplitude) highest = k;
  }
  if (highest == 0) return core::kNaN;
  spectrum[0] = 1.0;
  double length = 0.0;
  for (std::size_t k = 1; k <= highest; ++k) length += std::hypot(1.0 / static_cast<double>(highest), spectrum[k] - spectrum[k - 1]);
  return -length;
}

}  // namespace dts::pipeline
