// SPDX-License-Identifier: Apache-2.0
#include "record/reach_record.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "record/event_values.h"

namespace dts::record {
namespace {

constexpr std::array<std::string_view, 5> kSteps{"p1", "p2", "p3", "final", "cancelled"};  // index: ReachStep - 1

core::ReachPoint point_of(EventValues& values, const std::string& name) {
  return {.scan = {values.count<std::uint64_t>(name + "_scan")}, .value_mm = values.number(name + "_mm")};
}

void add_point(RecordedEvent& out, const std::string& name, const core::ReachPoint& point) {
  out.values.emplace_back(name + "_scan", static_cast<std::int64_t>(point.scan.value));
  out.values.emplace_back(name + "_mm", point.value_mm);
}

}  // namespace

RecordedEvent to_record(const core::ReachEvent& event) {
  RecordedEvent out{.event = "reach", .segment = event.segment, .scan = event.scan};
  const auto step = static_cast<std::size_t>(event.step) - 1;
  out.values.emplace_back("step", std::string(kSteps.at(std::min(step, kSteps.size() - 1))));
  out.values.emplace_back("number", std::int64_t{event.number});
  add_point(out, "p1", event.p1);
  add_point(out, "p2", event.p2);
  add_point(out, "p3", event.p3);
  const core::ReachFeatures& features = event.features;
  out.values.emplace_back("hold_mm", features.hold_mm);
  out.values.emplace_back("rise_s", features.rise_s);
  out.values.emplace_back("rest_ratio", features.rest_ratio);
  out.values.emplace_back("ratio_change", features.ratio_change);
  out.values.emplace_back("twist", features.twist);
  out.values.emplace_back("smoothness", features.smoothness);
  out.values.emplace_back("flags", std::int64_t{event.flags});
  out.values.emplace_back("resumed", std::int64_t{event.resumed});
  return out;
}

core::Result<core::ReachEvent> reach_of(const RecordedEvent& event) {
  EventValues values(event);
  core::ReachEvent reach{.segment = event.segment, .scan = event.scan};
  const auto step = std::ranges::find(kSteps, text_of(event, "step"));
  if (step == kSteps.end()) {
    values.refuse("step");
  } else {
    reach.step = static_cast<core::ReachStep>(step - kSteps.begin() + 1);
  }
  reach.number = values.count<std::uint32_t>("number");
  reach.p1 = point_of(values, "p1");
  reach.p2 = point_of(values, "p2");
  reach.p3 = point_of(values, "p3");
  reach.features = {.p1_mm = reach.p1.value_mm,
                    .p2_mm = reach.p2.value_mm,
                    .p3_mm = reach.p3.value_mm,
                    .hold_mm = values.number("hold_mm"),
                    .rise_s = values.number("rise_s"),
                    .rest_ratio = values.number("rest_ratio"),
                    .ratio_change = values.number("ratio_change"),
                    .twist = values.number("twist"),
                    .smoothness = values.number("smoothness")};
  reach.flags = values.count<std::uint16_t>("flags");
  reach.resumed = values.count<std::uint16_t>("resumed");
  if (auto checked = values.check(); !checked) return tl::make_unexpected(checked.error());
  return reach;
}

RecordedEvent to_record(const core::ClassEvent& event) {
  const core::TrunkMovement& movement = event.movement;
  RecordedEvent out{.event = "class", .segment = event.segment, .scan = event.scan};
  out.values.emplace_back("number", std::int64_t{event.number});
  out.values.emplace_back("class", std::int64_t{static_cast<std::int8_t>(movement.trunk_class)});
  for (std::size_t k = 0; k < movement.probability.size(); ++k) {
    out.values.emplace_back("p_" + std::to_string(k + 1), movement.probability[k]);
  }
  out.values.emplace_back("trunk_deg", movement.trunk_deg);
  out.values.emplace_back("trunk_lo_deg", movement.trunk_lo_deg);
  out.values.emplace_back("trunk_hi_deg", movement.trunk_hi_deg);
  out.values.emplace_back("reasons", std::int64_t{movement.reasons});
  return out;
}

core::Result<core::ClassEvent> class_of(const RecordedEvent& event) {
  EventValues values(event);
  core::ClassEvent out{.number = values.count<std::uint32_t>("number"), .segment = event.segment, .scan = event.scan};
  core::TrunkMovement& movement = out.movement;
  movement.trunk_class = static_cast<core::TrunkClass>(values.whole("class", -1, 3));
  for (std::size_t k = 0; k < movement.probability.size(); ++k) movement.probability[k] = values.number("p_" + std::to_string(k + 1));
  movement.trunk_deg = values.number("trunk_deg");
  movement.trunk_lo_deg = values.number("trunk_lo_deg");
  movement.trunk_hi_deg = values.number("trunk_hi_deg");
  movement.reasons = values.count<std::uint16_t>("reasons");
  if (auto checked = values.check(); !checked) return tl::make_unexpected(checked.error());
  return out;
}

}  // namespace dts::record
