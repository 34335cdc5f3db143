// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace dts::access {

/// Limits the events of each name to `per_second`, and to `burst` at once after a pause (a token bucket). Bounded: if there are many names,
/// forgets those whose bucket is full again. Thread: one.
class RateLimit {
 public:
  RateLimit(double per_second, double burst) : per_second_(per_second), burst_(burst) {}

  /// Returns true, and counts the event, if one more event is allowed now. `now_ns` must never decrease.
  [[nodiscard]] bool take(const std::string& name, std::int64_t now_ns);

 private:
  struct Bucket {
    double tokens = 0.0;
    std::int64_t filled_ns = 0;
  };
  [[nodiscard]] double tokens_now(const Bucket& bucket, std::int64_t now_ns) const noexcept;

  double per_second_;
  double burst_;
  std::map<std::string, Bucket> buckets_;
};

}  // namespace dts::access
