// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>

#include "core/clock.h"

namespace dts::device::sim {

/// The true time of a simulated stack. Its parts are devices of their own, with their own clocks, that are opened and started at different
/// moments. True time 0 is the moment on the host's clock at which the first part is started; the parts share it as long as one exists.
class StackTime {
 public:
  /// Returns the time of the stack with this clock and seed. Thread: any; locks.
  [[nodiscard]] static std::shared_ptr<StackTime> join(const core::Clock& clock, std::uint64_t seed);

  /// Returns the host time of true time 0; the first call sets it to `now_ns`. Thread: any. Realtime-safe: yes.
  [[nodiscard]] std::int64_t zero_ns(std::int64_t now_ns) noexcept;

 private:
  static constexpr std::int64_t kNotStarted = std::numeric_limits<std::int64_t>::min();

  std::atomic<std::int64_t> zero_ns_{kNotStarted};
};

}  // namespace dts::device::sim
