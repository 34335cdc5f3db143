// SPDX-License-Identifier: Apache-2.0
#include "pipeline/edge_detector.h"

#include <cmath>

#include "pipeline/stage_state.h"

namespace dts::pipeline {

core::Status check(const TriggerInput& input) {
  if (std::isfinite(input.level) && std::isfinite(input.hysteresis) && input.hysteresis >= 0.0) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "trigger: level and hysteresis must be numbers, the hysteresis not negative");
}

EdgeDetector::Side EdgeDetector::side_of(double volts) const noexcept {
  if (volts > input_.level + input_.hysteresis / 2.0) return Side::High;
  if (volts < input_.level - input_.hysteresis / 2.0) return Side::Low;
  return side_;  // within the band or NaN: no change
}

bool EdgeDetector::is_wanted(bool is_rising) const noexcept {
  return input_.edges == TriggerEdges::Both || (input_.edges == TriggerEdges::Rising) == is_rising;
}

void EdgeDetector::save(std::span<double> state) const noexcept { StateWriter(state).put_count(static_cast<std::uint64_t>(side_)); }

bool EdgeDetector::restore(std::span<const double> state) noexcept {
  StateReader reader(state, kStateSize);
  side_ = static_cast<Side>(reader.count(static_cast<std::uint64_t>(Side::High)));
  return reader.is_right();
}

void EdgeDetector::process(const core::Block& block, std::size_t column, core::TriggerEvents& out) noexcept {
  const auto volts = block.column(column);
  for (std::size_t i = 0; i < volts.size(); ++i) {
    const Side now = side_of(volts[i]);
    const bool is_crossing = side_ != Side::Unknown && now != side_;
    side_ = now;
    if (!is_crossing || !is_wanted(now == Side::High)) continue;
    out.push({.segment = block.segment,
              .scan = block.first_scan + i,
              .host_time_ns = block.host_time_ns + rate_.time_ns({i}),
              .is_rising = now == Side::High});
  }
}

}  // namespace dts::pipeline
