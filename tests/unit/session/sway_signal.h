// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/block.h"
#include "session/sway_results.h"

namespace dts::session {

inline constexpr double kRateHz = 100.0;

[[nodiscard]] inline core::Rate rate_100() { return *core::Rate::create(100, 1); }

/// Somebody who sways: two incommensurable circles, as a function of the scan.
[[nodiscard]] inline double ml_at(std::uint64_t scan) {
  const double t = static_cast<double>(scan) / kRateHz;
  return 3.0 * std::cos(2.0 * std::numbers::pi * 0.31 * t) + 1.0 * std::cos(2.0 * std::numbers::pi * 1.07 * t);
}
[[nodiscard]] inline double ap_at(std::uint64_t scan) {
  const double t = static_cast<double>(scan) / kRateHz;
  return 5.0 * std::sin(2.0 * std::numbers::pi * 0.23 * t) + 1.5 * std::sin(2.0 * std::numbers::pi * 0.9 * t);
}

[[nodiscard]] inline core::Block cop_block(std::uint64_t first, std::size_t count, std::uint32_t segment = 0, double scale = 1.0) {
  core::Block block(3, count);
  block.set_count(count);
  block.segment = segment;
  block.first_scan = {first};
  block.host_time_ns = static_cast<std::int64_t>(first) * 10'000'000;
  for (std::size_t i = 0; i < count; ++i) {
    block.column(0)[i] = scale * ml_at(first + i);
    block.column(1)[i] = scale * ap_at(first + i);
    block.column(2)[i] = 686.0;
  }
  return block;
}

[[nodiscard]] inline TrialEvent standing_step(TrialEventKind kind, std::uint32_t trial, std::string condition = "eyes-open-two-feet",
                                              std::uint32_t attempt = 1) {
  const std::string eyes = condition.find("closed") == std::string::npos ? "open" : "closed";
  return {.kind = kind, .trial = trial, .attempt = attempt, .condition = std::move(condition), .labels = {{"eyes", eyes}, {"feet", "two"}}};
}

}  // namespace dts::session
