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

/// One-sided density over the bins from kBandLowHz to kBandHighHz inclusive, without zero padding: bin m is at m rate / N.
struct Spectrum {
  double bin_hz = 0.0;
  std::size_t first_bin = 0;
  std::vector<double> density_mm2_per_hz;

  [[nodiscard]] double frequency_hz(std::size_t index) const noexcept { return static_cast<double>(first_bin + index) * bin_hz; }
};

/// Spectra by eight sine tapers (Riedel & Sidorenko 1995; "MT8"): RD minus its mean, AP, ML. Thread: any.
struct Spectra {
  Spectrum rd;
  Spectrum ap;
  Spectrum ml;
};
[[nodiscard]] Spectra multitaper_spectra(const Prepared& prepared);

/// Adds POWER, PF50, PF95, CFREQ, FREQD, MPF of RD, AP, ML, and MPF_RES_WELCHHALF; undefined values stay absent. Adds PF50 and PF95 only if
/// `with_quantiles`.
void add_frequency_domain(const Prepared& prepared, const Spectra& spectra, bool with_quantiles, Measures& measures);

}  // namespace dts::posturography
