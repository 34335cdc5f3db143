// SPDX-License-Identifier: Apache-2.0
#include "posturography/diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "posturography/fourier.h"
#include "posturography/stillness.h"

namespace dts::posturography {
namespace {

/// Sums over all pairs (n, n + k) of (x[n+k] - x[n])^2 for every lag k at once, for both axes: squares minus twice the products; the
/// products by the transform.
///
/// Each block of the record contains the pairs that start in it, and is centred on its own mean. This removes the slow drift of a long
/// record, which would otherwise cause a small difference of two large sums, and keeps the transforms short.
class PairSums {
 public:
  PairSums(std::size_t block, std::size_t lags)
      : block_(block),
        lags_(lags),
        transform_(smooth_length(block + lags)),
        packed_(transform_.size()),
        starts_(transform_.size()),
        ends_(transform_.size()),
        products_(transform_.size()),
        squares_ap_(lags + 1),
        squares_ml_(lags + 1) {}

  void add(std::span<const double> ap, std::span<const double> ml) {
    const std::size_t starts = std::min(block_, ap.size());
    const double mean_ap = mean_of(ap);
    const double mean_ml = mean_of(ml);
    std::ranges::fill(packed_, Complex{});
    for (std::size_t n = 0; n < ap.size(); ++n) packed_[n] = Complex(ap[n] - mean_ap, ml[n] - mean_ml);
    add_squares(std::span(packed_).first(ap.size()), starts);
    transform_.forward(packed_, ends_);
    std::fill(packed_.begin() + static_cast<std::ptrdiff_t>(starts), packed_.end(), Complex{});
    transform_.forward(packed_, starts_);
    for (std::size_t m = 0; m < products_.size(); ++m) {
      const auto [start_ap, start_ml] = unpacked(starts_, m);
      const auto [end_ap, end_ml] = unpacked(ends_, m);
      products_[m] += std::conj(start_ap) * end_ap + Complex(0.0, 1.0) * std::conj(start_ml) * end_ml;
    }
  }

  /// Must be called once, as the last call.
  void finish(std::span<double> ap, std::span<double> ml) {
    for (Complex& value : products_) value = std::conj(value);
    transform_.forward(products_, ends_);  // conjugated before and after: the inverse transform
    const double scale = 2.0 / static_cast<double>(ends_.size());
    for (std::size_t k = 1; k <= lags_; ++k) {
      ap[k] = squares_ap_[k] - scale * ends_[k].real();
      ml[k] = squares_ml_[k] + scale * ends_[k].imag();
    }
  }

  /// Returns the largest possible rounding error of any sum.
  [[nodiscard]] double error() const noexcept { return 16.0 * std::numeric_limits<double>::epsilon() * energy_; }

 private:
  /// Adds the squares of both ends of each pair, by running sums from the first sample on.
  void add_squares(std::span<const Complex> centred, std::size_t starts) {
    std::vector<Complex> running(centred.size() + 1);
    for (std::size_t n = 0; n < centred.size(); ++n) {
      running[n + 1] = running[n] + Complex(centred[n].real() * centred[n].real(), centred[n].imag() * centred[n].imag());
    }
    energy_ += running.back().real() + running.back().imag();
    for (std::size_t k = 1; k <= std::min(lags_, centred.size() - 1); ++k) {
      const std::size_t pairs = std::min(starts, centred.size() - k);
      const Complex squares = running[pairs] + (running[pairs + k] - running[k]);
      squares_ap_[k] += squares.real();
      squares_ml_[k] += squares.imag();
    }
  }

  std::size_t block_;
  std::size_t lags_;
  FourierTransform transform_;
  std::vector<Complex> packed_;
  std::vector<Complex> starts_;
  std::vector<Complex> ends_;
  std::vector<Complex> products_;
  std::vector<double> squares_ap_;
  std::vector<double> squares_ml_;
  double energy_ = 0.0;
};

/// Uses four parallel sums, so that one addition need not wait for the previous one.
double direct_sum(std::span<const double> values, std::size_t lag) noexcept {
  std::array<double, 4> sums{};
  const std::size_t pairs = values.size() - lag;
  std::size_t n = 0;
  for (; n + 4 <= pairs; n += 4) {
    for (std::size_t lane = 0; lane < 4; ++lane) {
      const double difference = values[n + lane + lag] - values[n + lane];
      sums[lane] += difference * difference;
    }
  }
  for (; n < pairs; ++n) {
    const double difference = values[n + lag] - values[n];
    sums[0] += difference * difference;
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// Turns sums into means. Computes a sum pair by pair if rounding may have changed it by more than 1e-10.
void settle(std::span<const double> values, double level, double error, std::vector<double>& sums) {
  constexpr double kRelativeError = 1e-10;
  const bool still = is_still(values, level);
  for (std::size_t k = 1; k < sums.size(); ++k) {
    if (still) {
      sums[k] = 0.0;
    } else if (!(kRelativeError * sums[k] > error)) {
      sums[k] = direct_sum(values, k);
    }
    sums[k] /= static_cast<double>(values.size() - k);
  }
}

struct Line {
  double slope = 0.0;
  double intercept = 0.0;
};

/// Ordinary least squares; nothing for fewer than two abscissae.
std::optional<Line> fitted(std::span<const double> x, std::span<const double> y) {
  if (x.size() < 2) return std::nullopt;
  const double mean_x = mean_of(x);
  const double mean_y = mean_of(y);
  double squares = 0.0;
  double products = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (x[i] - mean_x) * (x[i] - mean_x);
    products += (x[i] - mean_x) * (y[i] - mean_y);
  }
  if (!(squares > 0.0)) return std::nullopt;
  const double slope = products / squares;
  return Line{.slope = slope, .intercept = mean_y - slope * mean_x};
}

/// Returns the lags of one region in samples: multiples of 10 ms, each once, and only those still in the region after rounding.
std::vector<std::size_t> lags_of(double rate_hz, int first_10ms, int last_10ms) {
  constexpr double kSlack = 1e-3;  // a rate of 1499.96 Hz is treated as 1500 Hz
  std::vector<std::size_t> lags;
  for (int i = first_10ms; i <= last_10ms; ++i) {
    const double rounded = std::round(i * rate_hz / 100.0);  // exact for whole rates: 2.5 samples always become 3
    const bool is_inside =
        rounded >= 0.01 * first_10ms * rate_hz * (1.0 - kSlack) && rounded <= 0.01 * last_10ms * rate_hz * (1.0 + kSlack);
    const auto lag = static_cast<std::size_t>(rounded);
    if (lag > 0 && is_inside && (lags.empty() || lag != lags.back())) lags.push_back(lag);
  }
  return lags;
}

struct Region {
  std::optional<Line> linear;
  std::optional<Line> log_log;  ///< Absent where a displacement is 0.
};

/// Returns nothing if the curve ends within the region: a partial region would have another meaning under the same name.
Region region_of(std::span<const double> curve, double lag_step_s, std::span<const std::size_t> lags) {
  if (lags.empty() || lags.back() >= curve.size()) return {};
  std::vector<double> tau;
  std::vector<double> displacement;
  for (const std::size_t lag : lags) {
    tau.push_back(static_cast<double>(lag) * lag_step_s);
    displacement.push_back(curve[lag]);
  }
  Region region{.linear = fitted(tau, displacement), .log_log = std::nullopt};
  if (std::ranges::min(displacement) > 0.0) {
    for (double& value : tau) value = std::log(value);
    for (double& value : displacement) value = std::log(value);
    region.log_log = fitted(tau, displacement);
  }
  return region;
}

struct Regions {
  Region brief;    ///< 0 < tau <= 0.5 s
  Region lasting;  ///< 2 <= tau <= 10 s
};

Regions regions_of(std::span<const double> curve, double lag_step_s) {
  const double rate_hz = 1.0 / lag_step_s;
  return {.brief = region_of(curve, lag_step_s, lags_of(rate_hz, 1, 50)),
          .lasting = region_of(curve, lag_step_s, lags_of(rate_hz, 200, 1000))};
}

std::optional<double> crossing_of(const Regions& regions) {
  if (!regions.brief.linear || !regions.lasting.linear) return std::nullopt;
  const Line& brief = *regions.brief.linear;
  const Line& lasting = *regions.lasting.linear;
  const double tau_s = (lasting.intercept - brief.intercept) / (brief.slope - lasting.slope);
  if (!(tau_s > 0.0 && tau_s < 10.0)) return std::nullopt;
  return tau_s;
}

void add_diffusion(std::span<const double> curve, double lag_step_s, Axis axis, Measures& measures) {
  const Regions regions = regions_of(curve, lag_step_s);
  const auto& [brief, lasting] = regions;
  if (brief.linear) measures.set(of(Measure::SdaDsRes, axis), 0.5 * brief.linear->slope);
  if (lasting.linear) measures.set(of(Measure::SdaDlRes, axis), 0.5 * lasting.linear->slope);
  if (brief.log_log) measures.set(of(Measure::SdaHsRes, axis), 0.5 * brief.log_log->slope);
  if (lasting.log_log) measures.set(of(Measure::SdaHlRes, axis), 0.5 * lasting.log_log->slope);
  const std::optional<double> crossing = crossing_of(regions);
  if (crossing && brief.linear->slope > lasting.linear->slope) measures.set(of(Measure::SdaTcRes, axis), *crossing);
}

struct PublishedLag {
  Measure family;
  double tau_s;
};
constexpr std::array kPublishedLags{
    PublishedLag{.family = Measure::Msd100msRes, .tau_s = 0.1}, PublishedLag{.family = Measure::Msd500msRes, .tau_s = 0.5},
    PublishedLag{.family = Measure::Msd1sRes, .tau_s = 1.0},    PublishedLag{.family = Measure::Msd2sRes, .tau_s = 2.0},
    PublishedLag{.family = Measure::Msd5sRes, .tau_s = 5.0},    PublishedLag{.family = Measure::Msd10sRes, .tau_s = 10.0}};

}  // namespace

DisplacementCurve mean_square_displacement(const Prepared& prepared, double max_lag_s) {
  const std::size_t samples = prepared.size();
  if (!(prepared.rate_hz > 0.0) || !(max_lag_s > 0.0) || samples == 0) return {};
  const double wanted = std::min(std::round(max_lag_s * prepared.rate_hz), static_cast<double>(samples / 2));
  const auto lags = static_cast<std::size_t>(wanted);
  DisplacementCurve curve{
      .lag_step_s = 1.0 / prepared.rate_hz, .ap_mm2 = std::vector<double>(lags + 1), .ml_mm2 = std::vector<double>(lags + 1)};
  if (lags == 0) return curve;
  const std::size_t blocks = (samples + 8 * lags - 1) / (8 * lags);
  const std::size_t block = (samples + blocks - 1) / blocks;
  PairSums sums(block, lags);
  for (std::size_t first = 0; first < samples; first += block) {
    const std::size_t count = std::min(block + lags, samples - first);
    sums.add(std::span(prepared.ap_mm).subspan(first, count), std::span(prepared.ml_mm).subspan(first, count));
  }
  sums.finish(curve.ap_mm2, curve.ml_mm2);
  settle(prepared.ap_mm, prepared.mean_ap_mm, sums.error(), curve.ap_mm2);
  settle(prepared.ml_mm, prepared.mean_ml_mm, sums.error(), curve.ml_mm2);
  return curve;
}

void add_random_walk(const Prepared& prepared, const DisplacementCurve& curve, bool with_diffusion, Measures& measures) {
  if (curve.ap_mm2.empty() || curve.ml_mm2.size() != curve.ap_mm2.size() || !(curve.lag_step_s > 0.0)) return;
  std::vector<double> planar(curve.ap_mm2.size());
  std::ranges::transform(curve.ap_mm2, curve.ml_mm2, planar.begin(), std::plus<>{});
  const auto each = {std::pair{Axis::Planar, std::span<const double>(planar)}, std::pair{Axis::Ap, std::span<const double>(curve.ap_mm2)},
                     std::pair{Axis::Ml, std::span<const double>(curve.ml_mm2)}};
  for (const auto& [axis, values] : each) {
    for (const PublishedLag& lag : kPublishedLags) {
      const auto k = static_cast<std::size_t>(std::lround(lag.tau_s / curve.lag_step_s));
      if (k > 0 && k < values.size() && 2 * k <= prepared.size()) measures.set(of(lag.family, axis), values[k]);
    }
    if (with_diffusion) add_diffusion(values, curve.lag_step_s, axis, measures);
  }
}

}  // namespace dts::posturography
