// SPDX-License-Identifier: Apache-2.0
#include "posturography/spectrum.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "posturography/fourier.h"
#include "posturography/stillness.h"

namespace dts::posturography {
namespace {

constexpr std::size_t kTapers = 8;

struct Band {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Returns the bins m with low <= m rate / N <= high: a bin on an edge counts despite rounding.
std::optional<Band> band_of(std::size_t samples, double rate_hz) {
  if (samples == 0 || !(rate_hz > 0.0)) return std::nullopt;
  constexpr double kSlack = 1e-9;
  const double bins_per_hz = static_cast<double>(samples) / rate_hz;
  const double first = std::max(1.0, std::ceil(kBandLowHz * bins_per_hz * (1.0 - kSlack)));
  const double last = std::min(static_cast<double>(samples / 2), std::floor(kBandHighHz * bins_per_hz * (1.0 + kSlack)));
  if (!(first <= last)) return std::nullopt;
  return Band{.first = static_cast<std::size_t>(first), .last = static_cast<std::size_t>(last)};
}

/// Sine tapers in pairs, 1 and 2, then 3 and 4, ...: sin((k+1) a) = 2 cos(a) sin(k a) - sin((k-1) a). Without their factor sqrt(2 / (N +
/// 1)).
class TaperPairs {
 public:
  explicit TaperPairs(std::size_t samples) : twice_cosine_(samples), pair_(samples) {
    const double step = std::numbers::pi / static_cast<double>(samples + 1);
    for (std::size_t n = 0; n < samples; ++n) {
      const double angle = step * static_cast<double>(n + 1);
      twice_cosine_[n] = 2.0 * std::cos(angle);
      pair_[n] = Complex(std::sin(angle), twice_cosine_[n] * std::sin(angle));
    }
  }
  void advance() noexcept {
    for (std::size_t n = 0; n < pair_.size(); ++n) {
      const double odd = twice_cosine_[n] * pair_[n].imag() - pair_[n].real();
      pair_[n] = Complex(odd, twice_cosine_[n] * odd - pair_[n].imag());
    }
  }
  /// Returns the odd taper as real part, the even taper as imaginary part.
  [[nodiscard]] std::span<const Complex> pair() const noexcept { return pair_; }

 private:
  std::vector<double> twice_cosine_;
  std::vector<Complex> pair_;
};

/// Adds |DFT|^2 of the series under both tapers of the pair: of a transform of two real series, half of |Z[m]|^2 + |Z[N-m]|^2.
class PairEnergy {
 public:
  PairEnergy(std::size_t samples, const Band& band) : band_(band), transform_(samples, band.last), tapered_(samples), bins_(samples) {}

  void add(std::span<const double> series, std::span<const Complex> tapers, std::span<double> energy) {
    for (std::size_t n = 0; n < series.size(); ++n) tapered_[n] = series[n] * tapers[n];
    transform_.forward(tapered_, bins_);
    for (std::size_t m = band_.first; m <= band_.last; ++m) {
      energy[m - band_.first] += 0.5 * (std::norm(bins_[m]) + std::norm(bins_[bins_.size() - m]));
    }
  }

 private:
  Band band_;
  FourierTransform transform_;
  std::vector<Complex> tapered_;
  std::vector<Complex> bins_;
};

struct Series {
  std::vector<double> own{};  ///< Values of RD, which is not part of `Prepared`.
  std::span<const double> values{};
  bool still = true;
};

Series resultant_of(const Prepared& prepared) {
  Series series{.own = std::vector<double>(prepared.size())};
  for (std::size_t n = 0; n < series.own.size(); ++n) {
    series.own[n] = std::sqrt(prepared.ap_mm[n] * prepared.ap_mm[n] + prepared.ml_mm[n] * prepared.ml_mm[n]);
  }
  const double mean = std::accumulate(series.own.begin(), series.own.end(), 0.0) / static_cast<double>(series.own.size());
  for (double& value : series.own) value -= mean;
  series.values = series.own;
  series.still = is_still(series.values, mean);
  return series;
}

struct Moments {
  double mu0 = 0.0;
  double mu1 = 0.0;
  double mu2 = 0.0;
};

Moments moments_of(const Spectrum& spectrum) {
  Moments moments;
  for (std::size_t index = 0; index < spectrum.density_mm2_per_hz.size(); ++index) {
    const double frequency = spectrum.frequency_hz(index);
    const double density = spectrum.density_mm2_per_hz[index];
    moments.mu0 += density;
    moments.mu1 += frequency * density;
    moments.mu2 += frequency * frequency * density;
  }
  return moments;
}

/// Returns the smallest bin frequency at which the running sum reaches the share of the total; never interpolates.
double quantile_hz(const Spectrum& spectrum, double share, double all) {
  double sum = 0.0;
  for (std::size_t index = 0; index + 1 < spectrum.density_mm2_per_hz.size(); ++index) {
    sum += spectrum.density_mm2_per_hz[index];
    if (sum >= share * all) return spectrum.frequency_hz(index);
  }
  return spectrum.frequency_hz(spectrum.density_mm2_per_hz.size() - 1);
}

void add_axis(const Spectrum& spectrum, Axis axis, bool with_quantiles, Measures& measures) {
  if (spectrum.density_mm2_per_hz.empty()) return;
  const Moments moments = moments_of(spectrum);
  measures.set(of(Measure::PowerRd, axis), moments.mu0 * spectrum.bin_hz);
  if (!(moments.mu0 > 0.0)) return;  // no movement: no frequency is defined
  if (with_quantiles) {
    measures.set(of(Measure::Pf50Rd, axis), quantile_hz(spectrum, 0.5, moments.mu0));
    measures.set(of(Measure::Pf95Rd, axis), quantile_hz(spectrum, 0.95, moments.mu0));
  }
  measures.set(of(Measure::CfreqRd, axis), std::sqrt(moments.mu2 / moments.mu0));
  const double concentration = moments.mu1 / moments.mu0 * (moments.mu1 / moments.mu2);
  measures.set(of(Measure::FreqdRd, axis), std::sqrt(std::max(0.0, 1.0 - concentration)));
  measures.set(of(Measure::MpfRd, axis), moments.mu1 / moments.mu0);
}

/// Sums over the power spectrum of one axis from 0 to half the rate, in bins; independent of scale.
struct WholeBand {
  double area = 0.0;    ///< By the trapezoid rule.
  double moment = 0.0;  ///< Trapezoid rule for bin times power.
  double sum = 0.0;

  void add(double power, std::size_t bin, bool at_end) noexcept {
    const double weighted = at_end ? 0.5 * power : power;
    area += weighted;
    moment += weighted * static_cast<double>(bin);
    sum += power;
  }
};

struct PowerOfBoth {
  std::vector<double> ap;
  std::vector<double> ml;
};

/// Welch's method, like scipy.signal.welch: periodic Hann window, half overlap, the mean of each segment removed. One-sided, unscaled.
PowerOfBoth welch_of(const Prepared& prepared, std::size_t segment) {
  PowerOfBoth power{.ap = std::vector<double>(segment / 2 + 1), .ml = std::vector<double>(segment / 2 + 1)};
  std::vector<double> window(segment);
  const double step = 2.0 * std::numbers::pi / static_cast<double>(segment);
  for (std::size_t n = 0; n < segment; ++n) window[n] = 0.5 - 0.5 * std::cos(step * static_cast<double>(n));
  FourierTransform transform(segment);
  std::vector<Complex> packed(segment);
  std::vector<Complex> bins(segment);
  const std::size_t hop = segment - segment / 2;
  for (std::size_t first = 0; first + segment <= prepared.size(); first += hop) {
    const auto ap = std::span(prepared.ap_mm).subspan(first, segment);
    const auto ml = std::span(prepared.ml_mm).subspan(first, segment);
    const double mean_ap = mean_of(ap);
    const double mean_ml = mean_of(ml);
    for (std::size_t n = 0; n < segment; ++n) packed[n] = window[n] * Complex(ap[n] - mean_ap, ml[n] - mean_ml);
    transform.forward(packed, bins);
    for (std::size_t m = 0; m < power.ap.size(); ++m) {
      const double sides = m == 0 || 2 * m == segment ? 1.0 : 2.0;
      const auto [of_ap, of_ml] = unpacked(bins, m);
      power.ap[m] += sides * std::norm(of_ap);
      power.ml[m] += sides * std::norm(of_ml);
    }
  }
  return power;
}

/// Duarte's mean power frequency as in the public tables: segments of half the record, axes weighted by their power.
std::optional<double> welch_half_mpf_hz(const Prepared& prepared) {
  const std::size_t segment = (prepared.size() + 1) / 2;
  if (segment < 4) return std::nullopt;
  const bool ap_still = is_still(prepared.ap_mm, prepared.mean_ap_mm);
  const bool ml_still = is_still(prepared.ml_mm, prepared.mean_ml_mm);
  const PowerOfBoth power = welch_of(prepared, segment);
  WholeBand ap;
  WholeBand ml;
  for (std::size_t m = 0; m < power.ap.size(); ++m) {
    const bool at_end = m == 0 || m + 1 == power.ap.size();
    if (!ap_still) ap.add(power.ap[m], m, at_end);
    if (!ml_still) ml.add(power.ml[m], m, at_end);
  }
  double weighted = 0.0;
  if (ap.area > 0.0) weighted += ap.moment / ap.area * ap.sum;
  if (ml.area > 0.0) weighted += ml.moment / ml.area * ml.sum;
  if (!(ap.sum + ml.sum > 0.0)) return std::nullopt;
  return weighted / (ap.sum + ml.sum) * prepared.rate_hz / static_cast<double>(segment);
}

}  // namespace

Spectra multitaper_spectra(const Prepared& prepared) {
  Spectra spectra;
  const std::optional<Band> band = band_of(prepared.size(), prepared.rate_hz);
  if (!band) return spectra;
  const auto samples = static_cast<double>(prepared.size());
  const Series rd = resultant_of(prepared);
  const Series ap{.values = prepared.ap_mm, .still = is_still(prepared.ap_mm, prepared.mean_ap_mm)};
  const Series ml{.values = prepared.ml_mm, .still = is_still(prepared.ml_mm, prepared.mean_ml_mm)};
  for (Spectrum* spectrum : {&spectra.rd, &spectra.ap, &spectra.ml}) {
    *spectrum = {.bin_hz = prepared.rate_hz / samples,
                 .first_bin = band->first,
                 .density_mm2_per_hz = std::vector<double>(band->last - band->first + 1)};
  }
  TaperPairs tapers(prepared.size());
  PairEnergy energy(prepared.size(), *band);
  for (std::size_t pair = 0; pair < kTapers / 2; ++pair) {
    if (pair > 0) tapers.advance();
    if (!rd.still) energy.add(rd.values, tapers.pair(), spectra.rd.density_mm2_per_hz);
    if (!ap.still) energy.add(ap.values, tapers.pair(), spectra.ap.density_mm2_per_hz);
    if (!ml.still) energy.add(ml.values, tapers.pair(), spectra.ml.density_mm2_per_hz);
  }
  const double scale = 2.0 / (static_cast<double>(kTapers) * prepared.rate_hz) * (2.0 / (samples + 1.0));
  for (Spectrum* spectrum : {&spectra.rd, &spectra.ap, &spectra.ml}) {
    for (double& density : spectrum->density_mm2_per_hz) density *= scale;
  }
  return spectra;
}

void add_frequency_domain(const Prepared& prepared, const Spectra& spectra, bool with_quantiles, Measures& measures) {
  add_axis(spectra.rd, Axis::Planar, with_quantiles, measures);
  add_axis(spectra.ap, Axis::Ap, with_quantiles, measures);
  add_axis(spectra.ml, Axis::Ml, with_quantiles, measures);
  if (const std::optional<double> mpf = welch_half_mpf_hz(prepared)) measures.set(Measure::MpfResWelchhalf, *mpf);
}

}  // namespace dts::posturography
