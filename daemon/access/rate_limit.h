// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace dts::access {

/// So many events a second for each name, and `burst` at once after a rest (a token bucket). Bounded: a name whose bucket is full again
/// is forgotten when there are many. Thread: one.
class RateLimit {
 public:
  RateLimit(double per_second, double burst) : per_second_(per_second), burst_(burst) {}

  /// Whether one more may happen now; if so it is counted. `now_ns` does not go back.
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
