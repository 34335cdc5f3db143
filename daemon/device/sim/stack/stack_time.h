// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "core/clock.h"

namespace dts::device::sim {

/// The true time of a simulated stack. Its parts are devices of their own, with their own clocks, that are opened and started at different
/// moments. True time 0 is the moment on the host's clock at which the first part was created; the parts share it as long as one exists.
struct StackTime {
  std::int64_t zero_ns = 0;  ///< Host time of true time 0.

  /// Returns the time of the stack with this clock and seed; the first caller sets it to now. Thread: any; locks.
  [[nodiscard]] static std::shared_ptr<const StackTime> join(const core::Clock& clock, std::uint64_t seed);
};

}  // namespace dts::device::sim
