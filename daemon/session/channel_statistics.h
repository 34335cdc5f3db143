// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "core/block.h"
#include "core/latest_value.h"

namespace dts::session {

/// Mean, noise and extremes of one device channel, in its unit.
struct ChannelStatistics {
  double mean = 0.0;
  double noise_rms = 0.0;  ///< Standard deviation, 1/N.
  double minimum = 0.0;
  double maximum = 0.0;
};

struct StatisticsReport {
  std::uint64_t scans = 0;  ///< 0: no full period yet.
  std::size_t channel_count = 0;
  std::array<ChannelStatistics, core::kMaxChannels> channels{};
};

/// Statistics of every device channel over consecutive periods of about a second, for `dtsctl device test`.
class StatisticsCollector {
 public:
  StatisticsCollector(std::size_t channel_count, std::uint64_t period_scans);

  /// Thread: rig. Realtime-safe: yes.
  void add(const core::Block& block) noexcept;
  /// Restarts the period after a gap: scans before and after a gap do not belong together. Thread: rig. Realtime-safe: yes.
  void reset() noexcept { scans_ = 0; }
  /// Returns the last complete period. Thread: control (the one reader).
  [[nodiscard]] const StatisticsReport& latest() noexcept { return latest_.load(); }

 private:
  /// Sums of offsets from the period's first value: sums of the values themselves would lose the noise of a 5 V signal in rounding.
  struct Sums {
    double origin = 0.0;
    double sum = 0.0;
    double squares = 0.0;
    double minimum = 0.0;
    double maximum = 0.0;
  };
  void finish_period() noexcept;

  std::uint64_t period_scans_;
  std::uint64_t scans_ = 0;
  std::size_t channel_count_;
  std::array<Sums, core::kMaxChannels> sums_{};
  core::LatestValue<StatisticsReport> latest_;
};

}  // namespace dts::session
