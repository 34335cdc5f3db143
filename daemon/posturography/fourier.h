// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

namespace dts::posturography {

using Complex = std::complex<double>;

/// The discrete Fourier transform of one length, any length, in O(N log N): by kissfft where the prime factors are small, else by
/// Bluestein's chirp over a length whose factors are (Bluestein 1970). Errors are some 1e-15 of the root of the energy.
/// Thread: any, one at a time (it keeps its scratch).
class FourierTransform {
 public:
  explicit FourierTransform(std::size_t length) : FourierTransform(length, length / 2) {}
  /// Where only the bins 0 .. `highest_bin` and their mirrors are wanted: an awkward length then costs less.
  FourierTransform(std::size_t length, std::size_t highest_bin);
  ~FourierTransform();
  FourierTransform(FourierTransform&&) noexcept;
  FourierTransform& operator=(FourierTransform&&) noexcept;

  [[nodiscard]] std::size_t size() const noexcept;
  /// out[m] = sum over n of in[n] exp(-2 pi i m n / N) for the wanted bins m and N - m; what the others hold is not said. Both of size(),
  /// and not the same; nothing happens when they are of another size.
  void forward(std::span<const Complex> in, std::span<Complex> out);

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

/// The smallest length of at least `least` without prime factors above 5: the fastest to transform.
[[nodiscard]] std::size_t smooth_length(std::size_t least) noexcept;

/// Two real series share one transform as first + i second: bin m of each, m < size.
[[nodiscard]] inline std::pair<Complex, Complex> unpacked(std::span<const Complex> transform, std::size_t m) noexcept {
  const Complex here = transform[m];
  const Complex mirror = std::conj(transform[m == 0 ? 0 : transform.size() - m]);
  const Complex difference = 0.5 * (here - mirror);
  return {0.5 * (here + mirror), Complex(difference.imag(), -difference.real())};
}

}  // namespace dts::posturography
