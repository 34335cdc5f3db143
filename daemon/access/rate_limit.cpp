// SPDX-License-Identifier: Apache-2.0
#include "access/rate_limit.h"

#include <chrono>
#include <cstddef>

namespace dts::access {
namespace {

constexpr std::size_t kManyBuckets = 2000;  // the names are those of keys, of which there are at most 1000

}  // namespace

bool RateLimit::take(const std::string& name, std::int64_t now_ns) {
  const core::TokenBucket::Time now{std::chrono::nanoseconds(now_ns)};
  if (buckets_.size() >= kManyBuckets) std::erase_if(buckets_, [now](const auto& entry) { return entry.second.is_full(now); });
  return buckets_.try_emplace(name, full_).first->second.take(now);
}

}  // namespace dts::access
