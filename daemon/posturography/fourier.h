// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

namespace dts::posturography {

using Complex = std::complex<double>;

/// The discrete Fourier transform of one fixed length, which may be any number, in O(N log N). Uses kissfft if the prime factors of the
/// length are small, else Bluestein's chirp (Bluestein 1970) with a length whose factors are small. Errors are about 1e-15 of the root of
/// the energy.
/// Thread: any, one at a time (the object owns its scratch memory).
class FourierTransform {
 public:
  explicit FourierTransform(std::size_t length) : FourierTransform(length, length / 2) {}
  /// Computes only the bins 0 .. `highest_bin` and their mirrors, which costs less for a length with large prime factors.
  FourierTransform(std::size_t length, std::size_t highest_bin);
  ~FourierTransform();
  FourierTransform(FourierTransform&&) noexcept;
  FourierTransform& operator=(FourierTransform&&) noexcept;

  [[nodiscard]] std::size_t size() const noexcept;
  /// Computes out[m] = sum over n of in[n] exp(-2 pi i m n / N) for the wanted bins m and N - m; the other bins of `out` are unspecified.
  /// `in` and `out` must have size() elements and must not overlap; does nothing for another size.
  void forward(std::span<const Complex> in, std::span<Complex> out);

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

/// Returns the smallest length >= `least` without prime factors above 5: such lengths transform fastest.
[[nodiscard]] std::size_t smooth_length(std::size_t least) noexcept;

/// Returns bin m of each of two real series that share one transform as first + i second; m < size.
[[nodiscard]] inline std::pair<Complex, Complex> unpacked(std::span<const Complex> transform, std::size_t m) noexcept {
  const Complex here = transform[m];
  const Complex mirror = std::conj(transform[m == 0 ? 0 : transform.size() - m]);
  const Complex difference = 0.5 * (here - mirror);
  return {0.5 * (here + mirror), Complex(difference.imag(), -difference.real())};
}

}  // namespace dts::posturography
