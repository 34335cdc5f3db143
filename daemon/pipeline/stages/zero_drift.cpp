// SPDX-License-Identifier: Apache-2.0
#include "pipeline/stages/zero_drift.h"

#include <algorithm>
#include <cmath>

namespace dts::pipeline {
namespace {

constexpr double kLeavingMs = 1000.0;
constexpr std::uint64_t kFewestWindowScans = 3;
constexpr double kMostScans = 9e15;     // exact as a double
constexpr double kDoubtfulPart = 0.01;  // of the load
constexpr double kSecondsPerMinute = 60.0;
constexpr double kLargestSum = 1e15;  // limit for values from a file

/// Distance from the last of `scans` scans to their middle.
double to_middle(std::uint64_t scans) noexcept { return 0.5 * (static_cast<double>(scans) - 1.0); }

}  // namespace

void ZeroDrift::prepare(core::Rate rate, double window_ms) noexcept {
  window_scans_ = std::max(kFewestWindowScans, rate.scans_in_ms(window_ms));
  settle_scans_ = rate.scans_in_ms(kLeavingMs);
  scans_per_min_ = rate.hz() * kSecondsPerMinute;
  reset();
}

bool ZeroDrift::add(double vertical_n) noexcept {
  count_scan();
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
  sum_n_ += vertical_n - origin_n_;
  if (++scans_ < window_scans_) return false;
  level_n_ = origin_n_ + sum_n_ / static_cast<double>(window_scans_);
  since_level_ = to_middle(window_scans_);
  const bool has_line = has_begin_;
  if (has_line) {
    slope_n_per_scan_ = (level_n_ - begin_n_) / (since_begin_ - since_level_);
  } else {
    has_begin_ = true;
    begin_n_ = level_n_;
    since_begin_ = since_level_;
  }
  restart_window();
  return has_line;
}

void ZeroDrift::skip() noexcept {
  count_scan();
  restart_window();
}

void ZeroDrift::count_scan() noexcept {
  since_begin_ = std::min(since_begin_ + 1.0, kMostScans);
  since_level_ = std::min(since_level_ + 1.0, kMostScans);
}

void ZeroDrift::restart_window() noexcept {
  scans_ = 0;
  origin_n_ = 0.0;
  sum_n_ = 0.0;
}

void ZeroDrift::set_zero(std::uint64_t tare_scans) noexcept {
  has_begin_ = true;
  begin_n_ = level_n_ = 0.0;
  since_begin_ = since_level_ = to_middle(tare_scans);
  restart_window();
}

void ZeroDrift::resume() noexcept {
  contact_.reset();
  settling_ = settle_scans_;
  has_begin_ = false;
  restart_window();
}

void ZeroDrift::reset() noexcept {
  contact_.reset();
  settling_ = 0;
  has_begin_ = false;
  begin_n_ = since_begin_ = level_n_ = since_level_ = 0.0;
  slope_n_per_scan_.reset();
  restart_window();
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
  writer.put(has_begin_ ? 1.0 : 0.0);
  for (const double value : {begin_n_, since_begin_, level_n_, since_level_}) writer.put(value);
  writer.put(slope_n_per_scan_ ? 1.0 : 0.0);
  writer.put(slope_n_per_scan_.value_or(0.0));
}

void ZeroDrift::restore(StateReader& reader) noexcept {
  contact_.restore(reader);
  settling_ = reader.count(settle_scans_);
  scans_ = reader.count(window_scans_ - 1);
  origin_n_ = reader.number(-kLargestSum, kLargestSum);
  sum_n_ = reader.number(-kLargestSum, kLargestSum);
  has_begin_ = reader.flag();
  begin_n_ = reader.number(-kLargestSum, kLargestSum);
  since_begin_ = reader.number(0.0, kMostScans);
  level_n_ = reader.number(-kLargestSum, kLargestSum);
  since_level_ = reader.number(0.0, kMostScans);
  const bool has_slope = reader.flag();
  const double slope = reader.number(-kLargestSum, kLargestSum);
  slope_n_per_scan_ = has_slope ? std::optional(slope) : std::nullopt;
}

}  // namespace dts::pipeline
