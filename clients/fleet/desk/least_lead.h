// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace dts::fleet::desk {

/// How far a clinic's monotonic clock is ahead of ours, at least: nothing arrives before it was made. Forgets what is older than a minute,
/// because the clocks drift.
class LeastLead {
 public:
  /// A message that was made at `made_ns` of the clinic's clock has arrived at `now_ns` of ours.
  void add(std::int64_t made_ns, std::int64_t now_ns) {
    if (now_ns - began_ns_ > kSpan_ns) {
      before_ = now_ns - began_ns_ > 2 * kSpan_ns ? std::nullopt : present_;
      present_.reset();
      began_ns_ = now_ns;
    }
    present_ = std::max(present_.value_or(made_ns - now_ns), made_ns - now_ns);
  }
  /// Returns nothing before the first message.
  [[nodiscard]] std::optional<std::int64_t> ns() const { return std::max(before_, present_); }

 private:
  static constexpr std::int64_t kSpan_ns = 30'000'000'000;
  std::optional<std::int64_t> before_{};
  std::optional<std::int64_t> present_{};
  std::int64_t began_ns_ = 0;
};

}  // namespace dts::fleet::desk
