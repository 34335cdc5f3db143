// SPDX-License-Identifier: Apache-2.0
#include "access/rate_limit.h"

#include <algorithm>
#include <cstddef>

namespace dts::access {
namespace {

constexpr std::size_t kManyBuckets = 2000;  // the names are those of keys, of which there are at most 1000

}  // namespace

double RateLimit::tokens_now(const Bucket& bucket, std::int64_t now_ns) const noexcept {
  const double seconds = static_cast<double>(now_ns - bucket.filled_ns) * 1e-9;
  return std::min(burst_, bucket.tokens + std::max(0.0, seconds) * per_second_);
}

bool RateLimit::take(const std::string& name, std::int64_t now_ns) {
  if (buckets_.size() >= kManyBuckets)
    std::erase_if(buckets_, [&](const auto& entry) { return tokens_now(entry.second, now_ns) >= burst_; });
  const auto [at, is_new] = buckets_.try_emplace(name, Bucket{.tokens = burst_, .filled_ns = now_ns});
  Bucket& bucket = at->second;
  bucket.tokens = tokens_now(bucket, now_ns);
  bucket.filled_ns = now_ns;
  if (bucket.tokens < 1.0) return false;
  bucket.tokens -= 1.0;
  return true;
}

}  // namespace dts::access
