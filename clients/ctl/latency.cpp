// SPDX-License-Identifier: Apache-2.0
#include "ctl/latency.h"

#include <cmath>
#include <cstdint>

namespace dts::ctl {
namespace {

/// Returns the number of blocks within the bucket's bound. A smaller count than before belongs to a restarted daemon: `earlier` is then
/// ignored.
double blocks_within(const v1::LatencyHistogram& now, const v1::LatencyHistogram* earlier, int bucket) {
  const std::uint64_t all = now.buckets(bucket).blocks_total();
  const bool is_comparable = earlier != nullptr && earlier->buckets_size() == now.buckets_size();
  const std::uint64_t before = is_comparable ? earlier->buckets(bucket).blocks_total() : 0;
  return static_cast<double>(before <= all ? all - before : all);
}

}  // namespace

std::optional<double> latency_quantile_ms(const v1::LatencyHistogram& now, double share, const v1::LatencyHistogram* earlier) {
  const int count = now.buckets_size();
  const double total = count == 0 ? 0.0 : blocks_within(now, earlier, count - 1);
  if (!(total > 0.0)) return std::nullopt;
  const double wanted = share * total;
  double lower_ms = 0.0;
  double below = 0.0;
  for (int bucket = 0; bucket < count; ++bucket) {
    const double upper_ms = now.buckets(bucket).upper_ms();
    const double within = blocks_within(now, earlier, bucket);
    if (within >= wanted && within > below) {
      return std::isfinite(upper_ms) ? lower_ms + (upper_ms - lower_ms) * (wanted - below) / (within - below) : lower_ms;
    }
    lower_ms = upper_ms;
    below = within;
  }
  return lower_ms;
}

}  // namespace dts::ctl
