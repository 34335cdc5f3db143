// SPDX-License-Identifier: Apache-2.0
#include "posturography/fourier.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <kissfft/kissfft.hh>
#include <numbers>
#include <vector>

namespace dts::posturography {
namespace {

std::size_t without_factors(std::size_t length, std::initializer_list<std::size_t> factors) noexcept {
  for (const std::size_t factor : factors) {
    while (length % factor == 0) length /= factor;
  }
  return length;
}

/// kissfft has butterflies for 2, 3, 4 and 5. Any other factor p costs p multiplications per value; a chirp costs about 60 in total.
bool is_easy(std::size_t length) noexcept { return without_factors(length, {2, 3, 5, 7, 11, 13}) == 1; }

/// Returns exp(-i pi n^2 / N) for n = 0 .. count - 1. The square is computed modulo 2 N in integers: a floating-point phase would lose a
/// digit for each digit of N.
std::vector<Complex> chirp_of(std::size_t length, std::size_t count) {
  std::vector<Complex> chirp(count);
  const std::uint64_t period = 2 * static_cast<std::uint64_t>(length);
  std::uint64_t square = 0;
  for (std::size_t n = 0; n < count; ++n) {
    const double phase = -std::numbers::pi * static_cast<double>(square) / static_cast<double>(length);
    chirp[n] = Complex(std::cos(phase), std::sin(phase));
    square = (square + 2 * static_cast<std::uint64_t>(n) + 1) % period;
  }
  return chirp;
}

}  // namespace

/// Bluestein: m n = (m^2 + n^2 - (m - n)^2) / 2 turns the transform into a convolution with a chirp. Its length is free if all differences
/// m - n fit without wrapping onto a wanted bin.
struct FourierTransform::Plan {
  std::size_t length;
  std::size_t reach;  ///< The highest wanted bin.
  kissfft<double> inner;
  std::vector<Complex> chirp{};   ///< Empty: `inner` is the transform itself.
  std::vector<Complex> kernel{};  ///< Transform of the conjugated chirp, over its length.
  std::vector<Complex> padded{};
  std::vector<Complex> turned{};

  Plan(std::size_t size, std::size_t highest_bin)
      : length(size),
        reach(std::min(highest_bin, size / 2)),
        inner(is_easy(size) ? size : smooth_length(size + 2 * std::min(highest_bin, size / 2)), false) {
    if (!is_easy(size)) prepare_chirp(smooth_length(length + 2 * reach));
  }

  void prepare_chirp(std::size_t inner_length) {
    chirp = chirp_of(length, length + reach);
    padded.assign(inner_length, {});
    turned.assign(inner_length, {});
    kernel.assign(inner_length, {});
    const double scale = 1.0 / static_cast<double>(inner_length);
    for (std::size_t n = 0; n <= reach; ++n) padded[n] = scale * std::conj(chirp[n]);
    for (std::size_t n = 1; n < length + reach; ++n) padded[inner_length - n] = scale * std::conj(chirp[n]);
    inner.transform(padded.data(), kernel.data());
  }

  void forward_by_chirp(std::span<const Complex> in, std::span<Complex> out) {
    for (std::size_t n = 0; n < length; ++n) padded[n] = in[n] * chirp[n];
    std::fill(padded.begin() + static_cast<std::ptrdiff_t>(length), padded.end(), Complex{});
    inner.transform(padded.data(), turned.data());
    // The inverse transform is the forward transform with conjugation before and after.
    for (std::size_t m = 0; m < turned.size(); ++m) turned[m] = std::conj(turned[m] * kernel[m]);
    inner.transform(turned.data(), padded.data());
    for (std::size_t m = 0; m <= reach; ++m) out[m] = std::conj(padded[m]) * chirp[m];
    for (std::size_t m = 1; m <= reach; ++m) out[length - m] = std::conj(padded[padded.size() - m]) * chirp[m];
  }
};

FourierTransform::FourierTransform(std::size_t length, std::size_t highest_bin)
    : plan_(std::make_unique<Plan>(std::max<std::size_t>(length, 1), highest_bin)) {}
FourierTransform::~FourierTransform() = default;
FourierTransform::FourierTransform(FourierTransform&&) noexcept = default;
FourierTransform& FourierTransform::operator=(FourierTransform&&) noexcept = default;

std::size_t FourierTransform::size() const noexcept { return plan_->length; }

void FourierTransform::forward(std::span<const Complex> in, std::span<Complex> out) {
  if (in.size() != plan_->length || out.size() != plan_->length) return;
  if (plan_->chirp.empty()) {
    plan_->inner.transform(in.data(), out.data());
  } else {
    plan_->forward_by_chirp(in, out);
  }
}

std::size_t smooth_length(std::size_t least) noexcept {
  std::size_t length = std::max<std::size_t>(least, 1);
  while (without_factors(length, {2, 3, 5}) != 1) ++length;
  return length;
}

}  // namespace dts::posturography
