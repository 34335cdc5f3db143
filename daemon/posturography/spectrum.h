// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "posturography/measure.h"
#include "posturography/prepare.h"

namespace dts::posturography {

inline constexpr double kBandLowHz = 0.15;  ///< Prieto et al. 1996.
inline constexpr double kBandHighHz = 5.0;

/// One-sided density over the bins of the band, kBandLowHz .. kBandHighHz inclusive, never padded: bin m lies at m rate / N.
struct Spectrum {
  double bin_hz = 0.0;
  std::size_t first_bin = 0;
  std::vector<double> density_mm2_per_hz;

  [[nodiscard]] double frequency_hz(std::size_t index) const noexcept { return static_cast<double>(first_bin + index) * bin_hz; }
};

/// By eight sine tapers (Riedel & Sidorenko 1995; "MT8"): RD less its mean, AP, ML. Thread: any.
struct Spectra {
  Spectrum rd;
  Spectrum ap;
  Spectrum ml;
};
[[nodiscard]] Spectra multitaper_spectra(const Prepared& prepared);

/// POWER, PF50, PF95, CFREQ, FREQD, MPF of RD, AP, ML, and MPF_RES_WELCHHALF; what is not defined stays absent. PF50 and PF95 only with
/// `with_quantiles`.
void add_frequency_domain(const Prepared& prepared, const Spectra& spectra, bool with_quantiles, Measures& measures);

}  // namespace dts::posturography
