// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace dts::session {

/// The highest recent value: at least the last 15 s count, and nothing older than 45 s. Reading changes nothing, so that any number of
/// monitors may read at any interval. Trivially copyable, for the reports of other threads. Realtime-safe: yes.
///
///     [ before ............ ][ now ...   ]      two windows; the older is dropped when the newer is full
class RecentPeak {
 public:
  static constexpr std::int64_t kWindowNs = 15'000'000'000;

  void note(std::size_t value, std::int64_t now_ns) noexcept {
    if (now_ns - since_ns_ >= kWindowNs) {
      before_ = now_ns - since_ns_ < 2 * kWindowNs ? now_ : 0;
      now_ = 0;
      since_ns_ = now_ns;
    }
    now_ = std::max(now_, value);
  }
  [[nodiscard]] std::size_t at(std::int64_t now_ns) const noexcept {
    if (now_ns - since_ns_ >= 2 * kWindowNs) return 0;
    return now_ns - since_ns_ >= kWindowNs ? now_ : std::max(now_, before_);
  }

 private:
  std::size_t now_ = 0;
  std::size_t before_ = 0;
  std::int64_t since_ns_ = 0;
};

}  // namespace dts::session
