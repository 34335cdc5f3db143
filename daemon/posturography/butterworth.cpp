// SPDX-License-Identifier: Apache-2.0
#include "posturography/butterworth.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace dts::posturography {
namespace {

const std::array<double, 2> kDampings{2.0 * std::sin(3.0 * std::numbers::pi / 8.0), 2.0 * std::sin(std::numbers::pi / 8.0)};

double prewarped(double cutoff_hz, double rate_hz) noexcept { return std::tan(std::numbers::pi * cutoff_hz / rate_hz); }

/// One pair of poles of the prototype, 1 / (s^2 + damping s + 1), at the prewarped cut-off tan(pi fc / fs).
Section bilinear(double damping, double warped) noexcept {
  const double square = warped * warped;
  const double norm = 1.0 + damping * warped + square;
  Section section;
  section.a1 = 2.0 * (square - 1.0) / norm;
  section.a2 = (1.0 - damping * warped + square) / norm;
  // Uses the rounded a1 and a2 instead of square / norm: the gain at DC is then exactly 1 even if poles are close to z = 1.
  section.b0 = ((1.0 + section.a1) + section.a2) / 4.0;
  section.b1 = 2.0 * section.b0;
  section.b2 = section.b0;
  return section;
}

/// Filters all samples once, starting in the steady state of the first one.
template <class Iterator>
void run(const LowPass& sections, Iterator first, Iterator last) noexcept {
  CausalLowPass filter(sections);
  filter.settle_at(*first);
  for (; first != last; ++first) *first = filter.step(*first);
}

}  // namespace

LowPass butterworth4(double cutoff_hz, double rate_hz) noexcept {
  const double warped = prewarped(cutoff_hz, rate_hz);
  return {bilinear(kDampings[0], warped), bilinear(kDampings[1], warped)};
}

double lag_near_dc(double cutoff_hz, double rate_hz) noexcept {
  return (kDampings[0] + kDampings[1]) / (2.0 * prewarped(cutoff_hz, rate_hz));
}

void CausalLowPass::settle_at(double value) noexcept {
  for (std::size_t s = 0; s < sections_.size(); ++s) {
    state_[2 * s] = (1.0 - sections_[s].b0) * value;  // every section has gain 1 at DC, so each receives `value`
    state_[2 * s + 1] = (sections_[s].b2 - sections_[s].a2) * value;
  }
}

double CausalLowPass::step(double value) noexcept {
  for (std::size_t s = 0; s < sections_.size(); ++s) {
    const Section& of = sections_[s];
    const double in = value;
    value = of.b0 * in + state_[2 * s];
    state_[2 * s] = of.b1 * in - of.a1 * value + state_[2 * s + 1];
    state_[2 * s + 1] = of.b2 * in - of.a2 * value;
  }
  return value;
}

void filter_zero_phase(const LowPass& sections, std::span<double> values) {
  const std::size_t count = values.size();
  if (count <= kZeroPhasePadding) return;
  // Relative to the first sample: large offsets and constant series then lose nothing to rounding.
  const double origin = values.front();
  std::vector<double> padded(count + 2 * kZeroPhasePadding);
  for (std::size_t i = 0; i < count; ++i) padded[kZeroPhasePadding + i] = values[i] - origin;
  const double last = values.back() - origin;
  for (std::size_t k = 1; k <= kZeroPhasePadding; ++k) {
    padded[kZeroPhasePadding - k] = -(values[k] - origin);
    padded[kZeroPhasePadding + count - 1 + k] = 2.0 * last - (values[count - 1 - k] - origin);
  }
  run(sections, padded.begin(), padded.end());
  run(sections, padded.rbegin(), padded.rend());
  for (std::size_t i = 0; i < count; ++i) values[i] = padded[kZeroPhasePadding + i] + origin;
}

}  // namespace dts::posturography
