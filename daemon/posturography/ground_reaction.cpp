// SPDX-License-Identifier: Apache-2.0
#include "posturography/ground_reaction.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "core/special_numbers.h"
#include "posturography/clean_stretch.h"
#include "posturography/fourier.h"

namespace dts::posturography {
namespace {

using core::ErrorCode;
using core::kNaN;

constexpr double kMmPerM = 1e3;
constexpr double kHeightOfMass = 0.55;  ///< Of the body height (force-plates sheet section 8).
constexpr double kLengthOverHeight = 1.25;
constexpr double kEdge = 1.25;  ///< The band ends at this multiple of its highest frequency, and begins at 1/1.25 of its lowest.
constexpr double kPaddingS = 10.0;

/// Rises from 0 at frequency `from_hz` to 1 at `to_hz`.
double rise(double hz, double from_hz, double to_hz) {
  const double part = std::clamp(std::log(hz / from_hz) / std::log(to_hz / from_hz), 0.0, 1.0);
  return 0.5 - 0.5 * std::cos(std::numbers::pi * part);
}

/// Returns the force in N per mm of the centre of pressure at one frequency.
double response(double hz, double mass_kg, double length_m) {
  if (hz <= 0.0) return 0.0;
  const double w = 2.0 * std::numbers::pi * hz;
  const double w0_squared = kGravity / length_m;
  const double band = rise(hz, kLowestForceHz / kEdge, kLowestForceHz) * (1.0 - rise(hz, kHighestForceHz, kHighestForceHz * kEdge));
  return -mass_kg * w0_squared * w * w / (w0_squared + w * w) * band / kMmPerM;
}

/// Subtracts the straight line of least squares.
void detrend(std::span<double> values) {
  const double n = static_cast<double>(values.size());
  const double middle = 0.5 * (n - 1.0);
  double sum = 0.0;
  double moment = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sum += values[i];
    moment += (static_cast<double>(i) - middle) * values[i];
  }
  const double slope = moment / (n * (n * n - 1.0) / 12.0);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= sum / n + slope * (static_cast<double>(i) - middle);
}

/// Computes the force in one stretch. Both axes share one transform, because the response is real.
class ForceFilter {
 public:
  ForceFilter(StretchCopy copy, double rate_hz) : ml_mm_(std::move(copy.ml_mm)), ap_mm_(std::move(copy.ap_mm)), rate_hz_(rate_hz) {}

  void run(double mass_kg, double length_m) {
    detrend(ml_mm_);
    detrend(ap_mm_);
    const std::size_t padding = std::min(ml_mm_.size() - 1, static_cast<std::size_t>(kPaddingS * rate_hz_));
    const std::size_t length = smooth_length(ml_mm_.size() + 2 * padding);
    std::vector<Complex> in(length);
    std::vector<Complex> out(length);
    for (std::size_t i = 0; i < length; ++i) in[i] = reflected(i, padding);
    FourierTransform transform(length);
    transform.forward(in, out);
    for (std::size_t m = 0; m < length; ++m) {
      const double hz = static_cast<double>(std::min(m, length - m)) * rate_hz_ / static_cast<double>(length);
      in[m] = std::conj(out[m] * response(hz, mass_kg, length_m));  // the conjugate turns the forward transform into the inverse
    }
    transform.forward(in, out);
    for (std::size_t i = 0; i < ml_mm_.size(); ++i) {
      const Complex force = std::conj(out[padding + i]) / static_cast<double>(length);
      ml_mm_[i] = force.real();
      ap_mm_[i] = force.imag();
    }
  }

  /// After `run`: the forces in N.
  [[nodiscard]] const std::vector<double>& ml() const { return ml_mm_; }
  [[nodiscard]] const std::vector<double>& ap() const { return ap_mm_; }

 private:
  /// Returns sample `i` of the series with an odd reflection of `padding` samples at both ends; 0 after that.
  [[nodiscard]] Complex reflected(std::size_t i, std::size_t padding) const {
    const std::size_t n = ml_mm_.size();
    const auto at = [this](std::size_t k) { return Complex(ml_mm_[k], ap_mm_[k]); };
    if (i < padding) return 2.0 * at(0) - at(padding - i);
    if (i < padding + n) return at(i - padding);
    const std::size_t beyond = i - padding - n + 1;
    return beyond <= padding ? 2.0 * at(n - 1) - at(n - 1 - beyond) : Complex();
  }

  std::vector<double> ml_mm_;
  std::vector<double> ap_mm_;
  double rate_hz_;
};

core::Status check(const CopSeries& series, double body_height_m) {
  if (!(body_height_m >= 0.5 && body_height_m <= 2.5)) {
    return core::fail(ErrorCode::InvalidArgument, "a body height of " + std::to_string(body_height_m) + " m is not between 0.5 and 2.5 m");
  }
  if (series.load_n.empty()) return core::fail(ErrorCode::InvalidArgument, "the mass needs the load: there is no column load_n");
  if (series.ap_mm.size() != series.ml_mm.size() || series.load_n.size() != series.ml_mm.size()) {
    return core::fail(ErrorCode::InvalidArgument, "the columns differ in length");
  }
  if (!(series.rate_hz >= 10.0)) return core::fail(ErrorCode::InvalidArgument, "the rate is below 10 Hz");
  return {};
}

/// Sets the mass by the mean of the loads above 0 in these stretches: elsewhere, nobody may be on the plate.
void set_mass(const CopSeries& series, const std::vector<Stretch>& stretches, GroundReaction& result) {
  double sum_n = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (const Stretch& stretch : stretches) {
    for (const double load_n : std::span(series.load_n).subspan(stretch.begin, stretch.size())) {
      if (!(load_n > 0.0) || !std::isfinite(load_n)) continue;
      sum_n += load_n;
      squares += load_n * load_n;
      count += 1.0;
    }
  }
  if (count == 0.0) return;
  const double mean_n = sum_n / count;
  result.mass_kg = mean_n / kGravity;
  result.load_sd_n = std::sqrt(std::max(squares / count - mean_n * mean_n, 0.0));
}

}  // namespace

core::Result<GroundReaction> ground_reaction(const CopSeries& series, double body_height_m) {
  DTS_TRY(check(series, body_height_m));
  const std::size_t n = series.ml_mm.size();
  GroundReaction result{.ml_n = std::vector<double>(n, kNaN),
                        .ap_n = std::vector<double>(n, kNaN),
                        .effective_length_m = kLengthOverHeight * kHeightOfMass * body_height_m};
  const auto margin = static_cast<std::size_t>(std::ceil(kForceMarginS * series.rate_hz));
  std::vector<Stretch> stretches = clean_stretches(series).all;
  std::erase_if(stretches, [&](const Stretch& one) { return static_cast<double>(one.size()) < kShortestForceS * series.rate_hz; });
  set_mass(series, stretches, result);
  if (!stretches.empty() && !(result.mass_kg > 0.0))
    return core::fail(ErrorCode::InvalidArgument, "the mass needs the load: load_n is empty");
  for (const Stretch& stretch : stretches) {
    ForceFilter filter(copy_of(series, stretch), series.rate_hz);
    filter.run(result.mass_kg, result.effective_length_m);
    for (std::size_t i = margin; i < stretch.size() - margin; ++i) {
      result.ml_n[stretch.begin + i] = filter.ml()[i];
      result.ap_n[stretch.begin + i] = filter.ap()[i];
      ++result.supported;
    }
  }
  if (result.supported > 0) return result;
  return core::fail(ErrorCode::Failed, "no stretch with load lasts " + std::to_string(static_cast<int>(kShortestForceS)) + " s",
                    "record for longer");
}

}  // namespace dts::posturography
