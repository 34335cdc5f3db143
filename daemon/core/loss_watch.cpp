// SPDX-License-Identifier: Apache-2.0
#include "core/loss_watch.h"

#include <algorithm>
#include <limits>

namespace dts::core {
namespace {

/// If the lateness of nine bins is exponentially distributed, all nine exceed 1.8 times the mean once in ten million.
constexpr double kBeyondChance = 1.8;

/// The least lateness of some bins.
struct Floor {
  double least_ns = std::numeric_limits<double>::max();
  double sum_ns = 0.0;
  std::size_t count = 0;

  void add(double late_ns) noexcept {
    least_ns = std::min(least_ns, late_ns);
    sum_ns += late_ns;
    ++count;
  }
  /// Mean of the bins minus the least bin.
  [[nodiscard]] double scatter_ns() const noexcept { return count == 0 ? 0.0 : sum_ns / static_cast<double>(count) - least_ns; }
};

/// Returns the arrival time by the host's clock, relative to the nominal time of scan 0.
double arrival_s(const Arrival& arrival) noexcept { return arrival.time_s + arrival.late_ns * 1e-9; }

}  // namespace

void LossWatch::add(const Arrival& arrival, double steepest, double steepest_steady) noexcept {
  const double now_s = arrival_s(arrival);
  if (has_bin_ && now_s >= bin_end_s_) {
    close_bin();
    compare(now_s, std::clamp(median_slope(), steepest, steepest_steady));
  }
  if (!has_bin_) {
    bin_ = arrival;
    bin_end_s_ = now_s + kBinSeconds;
    has_bin_ = true;
  } else if (arrival.late_ns < bin_.late_ns) {  // within a bin the drift of the clock is negligible
    bin_ = arrival;
  }
}

void LossWatch::close_bin() noexcept {
  if (bin_count_ == bins_.size()) {
    std::shift_left(bins_.begin(), bins_.end(), 1);
    --bin_count_;
  }
  bins_[bin_count_++] = bin_;
  has_bin_ = false;
}

/// Returns the median growth of the lateness from bin to bin, seconds per second. Needs a bin.
double LossWatch::median_slope() const noexcept {
  std::array<double, kBins> slopes{};  // one is left over: with one bin the median is 0
  for (std::size_t i = 1; i < bin_count_; ++i) {
    slopes[i - 1] = (bins_[i].late_ns - bins_[i - 1].late_ns) * 1e-9 / std::max(bins_[i].time_s - bins_[i - 1].time_s, kBinSeconds / 10);
  }
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(bin_count_ / 2);
  std::nth_element(slopes.begin(), middle, slopes.begin() + static_cast<std::ptrdiff_t>(bin_count_));
  return *middle;
}

void LossWatch::compare(double now_s, double slope) noexcept {
  Floor recent;
  Floor before;
  for (std::size_t age = 0; age < bin_count_; ++age) {
    const Arrival& bin = bins_[bin_count_ - 1 - age];
    const bool is_recent = age < kLeastRecent || now_s - arrival_s(bin) <= kRecentSeconds;
    // Lateness that the clock explains does not count.
    (is_recent ? recent : before).add(bin.late_ns - slope * 1e9 * bin.time_s);
  }
  has_compared_ = before.count > 0;
  rise_ns_ = !has_compared_ ? 0 : static_cast<std::int64_t>(std::max(0.0, recent.least_ns - before.least_ns));
  chance_ns_ = static_cast<std::int64_t>(kBeyondChance * std::max(recent.scatter_ns(), before.scatter_ns()));
}

}  // namespace dts::core
