// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/token_bucket.h"

namespace dts::access {

/// A token bucket for each name. Bounded: if there are many names, forgets those whose bucket is full again. Thread: one.
class RateLimit {
 public:
  RateLimit(double per_second, double burst) : full_(per_second, burst) {}

  /// Returns true, and counts the event, if one more event is allowed now.
  [[nodiscard]] bool take(const std::string& name, std::int64_t now_ns);

 private:
  core::TokenBucket full_;
  std::map<std::string, core::TokenBucket> buckets_;
};

}  // namespace dts::access
