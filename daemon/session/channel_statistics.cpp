// SPDX-License-Identifier: Apache-2.0
#include "session/channel_statistics.h"

#include <algorithm>
#include <cmath>

namespace dts::session {

StatisticsCollector::StatisticsCollector(std::size_t channel_count, std::uint64_t period_scans)
    : period_scans_(std::max<std::uint64_t>(period_scans, 1)), channel_count_(std::min(channel_count, core::kMaxChannels)) {}

void StatisticsCollector::add(const core::Block& block) noexcept {
  if (block.channel_count() != channel_count_ || block.count() == 0) return;
  for (std::size_t channel = 0; channel < channel_count_; ++channel) {
    const auto column = block.column(channel);
    Sums& sums = sums_[channel];
    if (scans_ == 0) sums = {.origin = column[0], .minimum = column[0], .maximum = column[0]};
    for (const double value : column) {
      const double offset = value - sums.origin;
      sums.sum += offset;
      sums.squares += offset * offset;
      sums.minimum = std::min(sums.minimum, value);
      sums.maximum = std::max(sums.maximum, value);
    }
  }
  scans_ += block.count();
  if (scans_ >= period_scans_) finish_period();
}

void StatisticsCollector::finish_period() noexcept {
  StatisticsReport report{.scans = scans_, .channel_count = channel_count_};
  const auto count = static_cast<double>(scans_);
  for (std::size_t channel = 0; channel < channel_count_; ++channel) {
    const Sums& sums = sums_[channel];
    const double mean_offset = sums.sum / count;
    report.channels[channel] = {.mean = sums.origin + mean_offset,
                                .noise_rms = std::sqrt(std::max(0.0, sums.squares / count - mean_offset * mean_offset)),
                                .minimum = sums.minimum,
                                .maximum = sums.maximum};
  }
  latest_.store(report);
  scans_ = 0;
}

}  // namespace dts::session
