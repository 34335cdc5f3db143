// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace dts::ctl {

/// The rights of this user on this machine that affect latency.
struct SystemFacts {
  bool may_use_fifo = false;         ///< A thread of this user was allowed to become SCHED_FIFO.
  std::uint64_t lockable_bytes = 0;  ///< The largest value means no limit.
  std::string clock_source;          ///< "tsc"; empty when unknown.
  /// The kernel's clock is synchronised (NTP, PTP); absent: the system does not say.
  std::optional<bool> is_clock_set = true;
};

[[nodiscard]] SystemFacts gather_system_facts();

/// Returns whether a program on this machine listens at the port of this IPv4 address, such as "tcp://*:5555"; true if the system does not
/// say. Does not connect: dts-relay would report a stranger.
[[nodiscard]] bool has_listener(const std::string& endpoint);

}  // namespace dts::ctl
