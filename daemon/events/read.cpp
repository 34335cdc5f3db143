// SPDX-License-Identifier: Apache-2.0
#include "events/read.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dts/wire/options.h"

namespace dts::events {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

core::ReachPoint point_of(bool is_known, const v1::ReachPoint& point) {
  if (!is_known || !std::isfinite(point.value_mm())) return {};
  return {.scan = {point.scan()}, .value_mm = point.value_mm()};
}

/// Returns NaN for a number that is absent or not finite.
double known(bool is_known, double value) { return is_known && std::isfinite(value) ? value : kUnknown; }

bool is_16_bit(std::uint32_t number) { return number <= std::numeric_limits<std::uint16_t>::max(); }

auto damaged(const std::string& what) { return core::fail(core::ErrorCode::DataDamaged, what); }

}  // namespace

core::Error damaged(const v1::Event& event, const char* field) {
  return {.code = core::ErrorCode::DataDamaged,
          .what = "event \"" + wire::kind_of(event) + "\" at segment " + std::to_string(event.segment()) + ", scan " +
                  std::to_string(event.scan()) + ": \"" + field + "\" is missing or impossible",
          .hint = {}};
}

core::Result<core::ReachEvent> reach_of(const v1::Event& event) {
  const v1::Reach& message = event.reach();
  if (message.step() < v1::REACH_STEP_P1 || message.step() > v1::REACH_STEP_CANCELLED) return tl::make_unexpected(damaged(event, "step"));
  if (!is_16_bit(message.flags())) return tl::make_unexpected(damaged(event, "flags"));
  if (!is_16_bit(message.resumed())) return tl::make_unexpected(damaged(event, "resumed"));
  core::ReachEvent reach{.step = static_cast<core::ReachStep>(message.step()),
                         .number = message.number(),
                         .segment = event.segment(),
                         .scan = {event.scan()},
                         .host_time_ns = event.host_time_ns(),
                         .p1 = point_of(message.has_p1(), message.p1()),
                         .p2 = point_of(message.has_p2(), message.p2()),
                         .p3 = point_of(message.has_p3(), message.p3()),
                         .features = {},
                         .flags = static_cast<std::uint16_t>(message.flags()),
                         .resumed = static_cast<std::uint16_t>(message.resumed())};
  reach.features = {.p1_mm = reach.p1.value_mm,
                    .p2_mm = reach.p2.value_mm,
                    .p3_mm = reach.p3.value_mm,
                    .hold_mm = known(message.has_hold_mm(), message.hold_mm()),
                    .rise_s = known(message.has_rise_s(), message.rise_s()),
                    .rest_ratio = known(message.has_rest_ratio(), message.rest_ratio()),
                    .ratio_change = known(message.has_ratio_change(), message.ratio_change()),
                    .twist = known(message.has_twist(), message.twist()),
                    .smoothness = known(message.has_smoothness(), message.smoothness())};
  return reach;
}

core::Result<core::ClassEvent> class_of(const v1::Event& event) {
  const v1::TrunkMovement& message = event.movement();
  core::ClassEvent out{
      .number = message.number(), .segment = event.segment(), .scan = {event.scan()}, .host_time_ns = event.host_time_ns(), .movement = {}};
  core::TrunkMovement& movement = out.movement;
  const bool is_class = event.has_movement() && message.trunk_class() >= -1 && message.trunk_class() <= 3;
  if (!is_class) return tl::make_unexpected(damaged(event, "trunk_class"));
  if (!is_16_bit(message.reasons())) return tl::make_unexpected(damaged(event, "reasons"));
  if (static_cast<std::size_t>(message.probability_size()) != movement.probability.size()) {
    return tl::make_unexpected(damaged(event, "probability"));
  }
  if (!std::ranges::all_of(message.probability(), [](double share) { return share >= 0.0 && share <= 1.0; })) {
    return tl::make_unexpected(damaged(event, "probability"));
  }
  movement.trunk_class = static_cast<core::TrunkClass>(message.trunk_class());
  std::ranges::copy(message.probability(), movement.probability.begin());
  movement.trunk_deg = known(message.has_trunk_deg(), message.trunk_deg());
  movement.trunk_lo_deg = known(message.has_trunk_lo_deg(), message.trunk_lo_deg());
  movement.trunk_hi_deg = known(message.has_trunk_hi_deg(), message.trunk_hi_deg());
  movement.reasons = static_cast<std::uint16_t>(message.reasons());
  return out;
}

core::Result<posturography::Analysis> analysis_of(const v1::Sway& sway) {
  posturography::Analysis analysis;
  const auto profile = posturography::profile_named(sway.profile());
  if (!profile) return damaged("its \"profile\" is unknown");
  analysis.profile = *profile;
  analysis.rate_hz = sway.rate_hz();
  analysis.duration_s = sway.duration_s();
  if (!(analysis.rate_hz > 0.0) || analysis.rate_hz > 1e6) return damaged("its \"rate_hz\" is missing or impossible");
  if (!(analysis.duration_s > 0.0) || analysis.duration_s > 1e9) return damaged("its \"duration_s\" is missing or impossible");
  if (sway.samples() == 0) return damaged("its \"samples\" are missing");
  analysis.samples = sway.samples();
  if (!sway.has_flags()) return damaged("its \"flags\" are missing");
  analysis.flags = sway.flags();
  analysis.missing = sway.missing();
  analysis.interpolated = sway.interpolated();
  for (const v1::SwayMeasure& entry : sway.measures()) {
    if (!std::isfinite(entry.value())) return damaged("its measure \"" + entry.symbol() + "\" has no value");
    const auto measure = posturography::measure_named(entry.symbol());
    if (measure && posturography::info(*measure).unit == entry.unit()) analysis.measures.set(*measure, entry.value());
  }
  return analysis;
}

}  // namespace dts::events
