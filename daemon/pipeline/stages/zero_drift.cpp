// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/zero_drift.h"

#include <algorithm>
#include <cmath>

namespace dts::pipeline {
namespace {

constexpr double kLeavingMs = 1000.0;
constexpr std::uint64_t kFewestWindowScans = 3;
constexpr std::uint64_t kMostScans = std::uint64_t{1} << 53U;
constexpr double kDoubtfulPart = 0.01;  // of the load
constexpr double kSecondsPerMinute = 60.0;
constexpr double kLargestSum = 1e15;  // limit for values from a file

}  // namespace

void ZeroDrift::prepare(core::Rate rate, double window_ms) noexcept {
  window_scans_ = std::max(kFewestWindowScans, rate.scans_in_ms(window_ms));
  settle_scans_ = rate.scans_in_ms(kLeavingMs);
  scans_per_min_ = rate.hz() * kSecondsPerMinute;
  reset();
}

bool ZeroDrift::add(double vertical_n) noexcept {
  since_level_ = std::min(since_level_ + 1, kMostScans);
  if (contact_.update(vertical_n - drifted_n())) {
    settling_ = settle_scans_;
    restart_window();
    return false;
  }
  if (settling_ > 0) {
    --settling_;
    return false;
  }
  if (scans_ == 0) origin_n_ = vertical_n;
  const double offset_n = vertical_n - origin_n_;
  sum_n_ += offset_n;
  weighted_sum_n_ += offset_n * static_cast<double>(scans_);
  if (++scans_ < window_scans_) return false;
  // The least-squares line over equidistant scans 0 .. n - 1, and its value at the last of them.
  const auto n = static_cast<double>(window_scans_);
  const double slope = (weighted_sum_n_ - 0.5 * (n - 1.0) * sum_n_) * 12.0 / (n * (n * n - 1.0));
  slope_n_per_scan_ = slope;
  level_n_ = origin_n_ + sum_n_ / n + 0.5 * (n - 1.0) * slope;
  since_level_ = 0;
  restart_window();
  return true;
}

void ZeroDrift::restart_window() noexcept {
  scans_ = 0;
  origin_n_ = 0.0;
  sum_n_ = 0.0;
  weighted_sum_n_ = 0.0;
}

void ZeroDrift::set_zero() noexcept {
  level_n_ = 0.0;
  since_level_ = 0;
  restart_window();
}

void ZeroDrift::resume() noexcept {
  contact_.reset();
  settling_ = settle_scans_;
  restart_window();
}

void ZeroDrift::reset() noexcept {
  contact_.reset();
  settling_ = 0;
  slope_n_per_scan_.reset();
  set_zero();
}

bool ZeroDrift::is_doubtful(double vertical_n) const noexcept {
  return vertical_n >= kEmptyBelowN && std::abs(drifted_n()) > kDoubtfulPart * vertical_n;
}

void ZeroDrift::save(StateWriter& writer) const noexcept {
  contact_.save(writer);
  writer.put_count(settling_);
  writer.put_count(scans_);
  writer.put(origin_n_);
  writer.put(sum_n_);
  writer.put(weighted_sum_n_);
  writer.put(level_n_);
  writer.put_count(since_level_);
  writer.put(slope_n_per_scan_ ? 1.0 : 0.0);
  writer.put(slope_n_per_scan_.value_or(0.0));
}

void ZeroDrift::restore(StateReader& reader) noexcept {
  contact_.restore(reader);
  settling_ = reader.count(settle_scans_);
  scans_ = reader.count(window_scans_ - 1);
  origin_n_ = reader.number(-kLargestSum, kLargestSum);
  sum_n_ = reader.number(-kLargestSum, kLargestSum);
  weighted_sum_n_ = reader.number(-kLargestSum, kLargestSum);
  level_n_ = reader.number(-kLargestSum, kLargestSum);
  since_level_ = reader.count(kMostScans);
  const bool has_slope = reader.flag();
  const double slope = reader.number(-kLargestSum, kLargestSum);
  slope_n_per_scan_ = has_slope ? std::optional(slope) : std::nullopt;
}

}  // namespace dts::pipeline
