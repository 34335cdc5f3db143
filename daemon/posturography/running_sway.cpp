// SPDX-License-Identifier: Apache-2.0
#include "posturography/running_sway.h"

#include <algorithm>
#include <cmath>

#include "posturography/ellipse.h"

namespace dts::posturography {
namespace {

constexpr double kMostSamples = 9007199254740992.0;  // 2^53: beyond this, adding one has no effect
constexpr double kLargest = 1e100;                   // largest number accepted from a file: no calculation with it overflows

}  // namespace

void RunningSwaySums::reset() noexcept { *this = RunningSwaySums(rate_hz_); }

void RunningSwaySums::add(double ml_mm, double ap_mm) noexcept {
  if (samples_ == 0.0) {
    least_ml_ = most_ml_ = ml_mm;
    least_ap_ = most_ap_ = ap_mm;
  } else {
    const double step_ml = is_interrupted_ ? 0.0 : ml_mm - last_ml_;
    const double step_ap = is_interrupted_ ? 0.0 : ap_mm - last_ap_;
    path_ += std::sqrt(step_ml * step_ml + step_ap * step_ap);
    path_ml_ += std::abs(step_ml);
    path_ap_ += std::abs(step_ap);
    least_ml_ = std::min(least_ml_, ml_mm);
    most_ml_ = std::max(most_ml_, ml_mm);
    least_ap_ = std::min(least_ap_, ap_mm);
    most_ap_ = std::max(most_ap_, ap_mm);
  }
  is_interrupted_ = false;
  last_ml_ = ml_mm;
  last_ap_ = ap_mm;
  samples_ += 1.0;
  const double from_mean_ml = ml_mm - mean_ml_;
  const double from_mean_ap = ap_mm - mean_ap_;
  mean_ml_ += from_mean_ml / samples_;
  mean_ap_ += from_mean_ap / samples_;
  square_ml_ += from_mean_ml * (ml_mm - mean_ml_);
  square_ap_ += from_mean_ap * (ap_mm - mean_ap_);
  product_ += from_mean_ml * (ap_mm - mean_ap_);
}

void RunningSwaySums::append(const RunningSwaySums& later, double first_ml_mm, double first_ap_mm) noexcept {
  if (later.empty()) return;
  if (empty()) {
    *this = later;
    return;
  }
  const double step_ml = first_ml_mm - last_ml_;
  const double step_ap = first_ap_mm - last_ap_;
  path_ += std::sqrt(step_ml * step_ml + step_ap * step_ap) + later.path_;
  path_ml_ += std::abs(step_ml) + later.path_ml_;
  path_ap_ += std::abs(step_ap) + later.path_ap_;
  least_ml_ = std::min(least_ml_, later.least_ml_);
  most_ml_ = std::max(most_ml_, later.most_ml_);
  least_ap_ = std::min(least_ap_, later.least_ap_);
  most_ap_ = std::max(most_ap_, later.most_ap_);
  const double samples = samples_ + later.samples_;
  const double part = later.samples_ / samples;
  const double weight = samples_ * part;
  const double from_mean_ml = later.mean_ml_ - mean_ml_;
  const double from_mean_ap = later.mean_ap_ - mean_ap_;
  square_ml_ += later.square_ml_ + from_mean_ml * from_mean_ml * weight;
  square_ap_ += later.square_ap_ + from_mean_ap * from_mean_ap * weight;
  product_ += later.product_ + from_mean_ml * from_mean_ap * weight;
  mean_ml_ += from_mean_ml * part;
  mean_ap_ += from_mean_ap * part;
  samples_ = samples;
  last_ml_ = later.last_ml_;
  last_ap_ = later.last_ap_;
}

core::RunningSway RunningSwaySums::values() const noexcept {
  core::RunningSway values{.samples = static_cast<std::uint64_t>(samples_), .rate_hz = rate_hz_};
  if (samples_ == 0.0) return values;
  values.mean_ml_mm = mean_ml_;
  values.mean_ap_mm = mean_ap_;
  values.rdist_mm = std::sqrt((square_ml_ + square_ap_) / samples_);
  values.rdist_ap_mm = std::sqrt(square_ap_ / samples_);
  values.rdist_ml_mm = std::sqrt(square_ml_ / samples_);
  values.totex_mm = path_;
  values.totex_ap_mm = path_ap_;
  values.totex_ml_mm = path_ml_;
  values.range_ap_mm = most_ap_ - least_ap_;
  values.range_ml_mm = most_ml_ - least_ml_;
  const double divisor = samples_ - 1.0;
  const auto ellipse = prediction_ellipse({.ml_ml = square_ml_ / divisor, .ml_ap = product_ / divisor, .ap_ap = square_ap_ / divisor},
                                          static_cast<std::size_t>(samples_));
  if (!ellipse) return values;
  values.ellipse_sd1_mm = ellipse->sd1_mm;
  values.ellipse_sd2_mm = ellipse->sd2_mm;
  values.ellipse_angle_deg = ellipse->angle_deg;
  values.pea95_f_mm2 = ellipse->area_mm2;
  return values;
}

std::array<double, RunningSwaySums::kStateSize> RunningSwaySums::state() const noexcept {
  return {samples_, mean_ml_, mean_ap_, square_ml_, square_ap_, product_,  path_,    path_ml_,
          path_ap_, last_ml_, last_ap_, least_ml_,  most_ml_,   least_ap_, most_ap_, 0.0};
}

bool RunningSwaySums::set_state(std::span<const double, kStateSize> state) noexcept {
  samples_ = state[0];
  mean_ml_ = state[1];
  mean_ap_ = state[2];
  square_ml_ = state[3];
  square_ap_ = state[4];
  product_ = state[5];
  path_ = state[6];
  path_ml_ = state[7];
  path_ap_ = state[8];
  last_ml_ = state[9];
  last_ap_ = state[10];
  least_ml_ = state[11];
  most_ml_ = state[12];
  least_ap_ = state[13];
  most_ap_ = state[14];
  is_interrupted_ = state[15] == 1.0;
  const bool is_possible = is_sane() && (state[15] == 0.0 || state[15] == 1.0) &&
                           std::ranges::all_of(state, [](double number) { return std::abs(number) <= kLargest; });
  if (!is_possible) reset();
  return is_possible;
}

/// Checks properties that all sums of samples have, except for the last bits of means and paths (rounding).
bool RunningSwaySums::is_sane() const noexcept {
  if (!(samples_ >= 0.0 && samples_ <= kMostSamples && samples_ == std::floor(samples_))) return false;
  if (samples_ == 0.0) return *this == RunningSwaySums(rate_hz_);
  if (!(square_ml_ >= 0.0 && square_ap_ >= 0.0 && path_ >= 0.0 && path_ml_ >= 0.0 && path_ap_ >= 0.0)) return false;
  return least_ml_ <= last_ml_ && last_ml_ <= most_ml_ && least_ap_ <= last_ap_ && last_ap_ <= most_ap_;
}

}  // namespace dts::posturography
