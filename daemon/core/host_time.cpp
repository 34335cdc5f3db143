// SPDX-License-Identifier: Apache-2.0
#include "core/host_time.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace dts::core {
namespace {

constexpr std::int64_t kBinNs = 1'000'000'000;
constexpr double kUnknownDrift = HostTime::kCrystalPpm * 1e-6;  // largest drift before it is measured
constexpr double kDriftDoubt = 50e-6;                           // possible error and change of a measured drift
constexpr std::int64_t kLeastLossNs = 3'500'000;
constexpr double kBadLuckNs = 20e6;
constexpr std::int64_t kImpossibleNs = 1'000'000'000;  // arrivals vary by less, even on a busy host
constexpr double kRateKnownSeconds = 2.0;
constexpr std::size_t kScatterBins = 10;
constexpr std::size_t kEnoughBins = 3;  // with fewer the scatter is unknown

/// Returns twice the area of the triangle: positive if c is above the line through a and b.
double turn(const Arrival& a, const Arrival& b, const Arrival& c) noexcept {
  return (b.time_s - a.time_s) * (c.late_ns - a.late_ns) - (b.late_ns - a.late_ns) * (c.time_s - a.time_s);
}

}  // namespace

void HostTime::restart(std::optional<std::int64_t> not_before_ns) noexcept {
  not_before_ns_ = not_before_ns;
  point_count_ = 0;
  has_bin_ = false;
  loss_watch_.restart();
  is_rate_known_ = false;
  rate_error_ = 0.0;
  height_ns_ = 0.0;
  last_index_ = {};
  last_ns_ = std::numeric_limits<std::int64_t>::min();
  scatter_ns_ = 0;
  held_back_ns_ = 0;
}

void HostTime::add(ScanIndex newest, std::int64_t arrived_ns) noexcept {
  const std::int64_t nominal_ns = rate_.time_ns(newest);
  // No scan arrives before it was sampled: behind a counted loss, the host's clock has stood still, and the old line says nothing about the
  // new arrivals. Until the rate is known, the device may only be fast.
  const bool is_behind_a_loss = is_rate_known_ && nominal_ns - rate_.time_ns(newest_) > kImpossibleNs;
  if (is_behind_a_loss && arrived_ns < estimate_ns(newest) - kImpossibleNs) restart();
  newest_ = newest;
  if (!has_bin_) {
    restart(not_before_ns_);
    origin_ns_ = arrived_ns - nominal_ns;
  } else if (arrived_ns >= bin_end_ns_) {
    close_bin();
    has_bin_ = false;
  }
  const Arrival arrival{static_cast<double>(nominal_ns) * 1e-9, static_cast<double>(arrived_ns - origin_ns_ - nominal_ns)};
  loss_watch_.add(arrival, steepest(), steepest_steady());
  if (!has_bin_) {
    bin_end_ns_ = arrived_ns + kBinNs;
    bin_ = arrival;
    has_bin_ = true;
  } else if (arrival.late_ns - line_ns(arrival.time_s) < bin_.late_ns - line_ns(bin_.time_s)) {
    bin_ = arrival;
  }
}

void HostTime::close_bin() noexcept {
  if (point_count_ == points_.size()) {
    std::copy(points_.begin() + 1, points_.end(), points_.begin());
    --point_count_;
  }
  points_[point_count_++] = bin_;
  draw_line();
}

std::int64_t HostTime::least_loss_ns() const noexcept { return std::max({kLeastLossNs, rate_.time_ns({1}) / 2, loss_watch_.chance_ns()}); }

double HostTime::largest_drift() const noexcept { return oscillator_ == Oscillator::Crystal ? kUnknownDrift : kLargestDriftPpm * 1e-6; }

/// Returns how fast the lateness may grow without a loss, seconds per second.
double HostTime::steepest() const noexcept {
  return is_drift_known_ ? std::clamp(slope_, -largest_drift(), largest_drift()) + kDriftDoubt : kUnknownDrift;
}

/// Returns how fast it may grow without a loss if it grows steadily.
double HostTime::steepest_steady() const noexcept {
  return oscillator_ == Oscillator::Crystal ? steepest() : std::max(steepest(), largest_drift());
}

/// Returns the slope of the edge of the lower hull at the mean time of all points: of all lines below the points, the line along this
/// edge has the least total distance to them. Needs at least two points.
double HostTime::edge_slope() noexcept {
  std::size_t corners = 0;
  double middle_s = 0.0;
  for (const Arrival& point : std::span(points_).first(point_count_)) {
    while (corners >= 2 && turn(hull_[corners - 2], hull_[corners - 1], point) <= 0.0) --corners;
    hull_[corners++] = point;
    middle_s += point.time_s / static_cast<double>(point_count_);
  }
  std::size_t right = 1;
  while (right + 1 < corners && hull_[right].time_s < middle_s) ++right;
  const Arrival& from = hull_[right - 1];
  const Arrival& to = hull_[right];
  return (to.late_ns - from.late_ns) * 1e-9 / (to.time_s - from.time_s);
}

void HostTime::draw_line() noexcept {
  const auto points = std::span(points_).first(point_count_);
  const double span_s = points.back().time_s - points.front().time_s;
  const double host_span_s = span_s + (points.back().late_ns - points.front().late_ns) * 1e-9;  // by the host's clock
  if (host_span_s >= kRateKnownSeconds) {
    is_rate_known_ = true;
    const double slope = edge_slope();
    const double doubt = kBadLuckNs * 1e-9 / span_s;
    rate_error_ = std::copysign(std::max(0.0, std::abs(slope) - doubt), slope);
    if (span_s >= kDriftKnownSeconds) {
      slope_ = std::clamp(slope, -kLargestDriftPpm * 1e-6, kLargestDriftPpm * 1e-6);
      is_drift_known_ = true;
    }
  }
  height_ns_ = std::numeric_limits<double>::max();
  for (const Arrival& point : points) height_ns_ = std::min(height_ns_, point.late_ns - slope_ * 1e9 * point.time_s);
  const auto recent = points.last(std::min(points.size(), kScatterBins));
  double scatter_ns = 0.0;
  for (const Arrival& point : recent) scatter_ns += (point.late_ns - line_ns(point.time_s)) / static_cast<double>(recent.size());
  const double drift_ns = is_drift_known_ ? 0.0 : kUnknownDrift * 1e9 * span_s;
  scatter_ns_ = static_cast<std::int64_t>(2.0 * scatter_ns + drift_ns);
}

std::int64_t HostTime::uncertainty_ns() const noexcept {
  const std::int64_t known_ns = frame_ns_ + scatter_ns_ + held_back_ns_;
  if (point_count_ >= kEnoughBins) return known_ns;
  // Scan 0 was sampled after the start request and before the earliest time that any arrival allows.
  const std::int64_t first_ns = origin_ns_ + static_cast<std::int64_t>(bin_.late_ns);
  return known_ns + (not_before_ns_ && has_bin_ ? std::max<std::int64_t>(0, first_ns - *not_before_ns_) : kUnknownLatenessNs);
}

/// Returns the time of a scan by the line. Needs a bin.
std::int64_t HostTime::estimate_ns(ScanIndex index) const noexcept {
  // No scan arrives before it was sampled: an arrival below the line lowers the estimate at once.
  const double line = point_count_ > 0 ? line_ns(bin_.time_s) : std::numeric_limits<double>::max();
  const double below_ns = std::min(bin_.late_ns, line) + slope_ * 1e9 * (nominal_s(index) - bin_.time_s);
  return origin_ns_ + rate_.time_ns(index) + static_cast<std::int64_t>(below_ns);
}

std::int64_t HostTime::at(ScanIndex index) noexcept {
  if (!has_bin_) return 0;
  std::int64_t time_ns = estimate_ns(index);
  if (index.value > last_index_.value && last_ns_ != std::numeric_limits<std::int64_t>::min()) {
    const std::int64_t earliest_ns = last_ns_ + rate_.time_ns({index.value - last_index_.value}) / 2;
    held_back_ns_ = std::max<std::int64_t>(0, earliest_ns - time_ns);
    time_ns = std::max(time_ns, earliest_ns);
  }
  last_index_ = index;
  last_ns_ = time_ns;
  return time_ns;
}

}  // namespace dts::core
