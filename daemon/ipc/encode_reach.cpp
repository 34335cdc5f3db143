// SPDX-License-Identifier: Apache-2.0
#include "ipc/encode_reach.h"

namespace dts::ipc {
namespace {

static_assert(static_cast<int>(core::ReachStep::Cancelled) == dts::v1::REACH_STEP_CANCELLED);
static_assert(core::reach_flag::kNoInitiation == dts::v1::REACH_FLAG_NO_INITIATION &&
              core::reach_flag::kMinor == dts::v1::REACH_FLAG_MINOR);
static_assert(core::class_reason::kDisagreement == dts::v1::CLASS_REASON_DISAGREEMENT);

void set_point(dts::v1::ReachPoint& out, const core::ReachPoint& point) {
  out.set_scan(point.scan.value);
  out.set_value_mm(point.value_mm);
}

void set_reach(dts::v1::Reach& out, const core::ReachEvent& event) {
  out.set_step(static_cast<dts::v1::ReachStep>(event.step));
  out.set_number(event.number);
  set_point(*out.mutable_p1(), event.p1);
  set_point(*out.mutable_p2(), event.p2);
  set_point(*out.mutable_p3(), event.p3);
  const core::ReachFeatures& features = event.features;
  out.set_d1_mm(features.d1_mm());
  out.set_d2_mm(features.d2_mm());
  out.set_hold_mm(features.hold_mm);
  out.set_rise_s(features.rise_s);
  out.set_rest_ratio(features.rest_ratio);
  out.set_ratio_change(features.ratio_change);
  out.set_twist(features.twist);
  out.set_smoothness(features.smoothness);
  out.set_flags(event.flags);
  out.set_resumed(event.resumed);
}

void set_movement(dts::v1::TrunkMovement& out, std::uint32_t number, const core::TrunkMovement& movement) {
  out.set_number(number);
  out.set_trunk_class(static_cast<int>(movement.trunk_class));
  for (const double probability : movement.probability) out.add_probability(probability);
  out.set_trunk_deg(movement.trunk_deg);
  out.set_trunk_lo_deg(movement.trunk_lo_deg);
  out.set_trunk_hi_deg(movement.trunk_hi_deg);
  out.set_reasons(movement.reasons);
}

template <class Told>
dts::v1::Event at_scan(std::uint64_t instance_id, const Told& told) {
  dts::v1::Event event;
  event.set_instance_id(instance_id);
  event.set_segment(told.segment);
  event.set_scan(told.scan.value);
  event.set_host_time_ns(told.host_time_ns);
  return event;
}

}  // namespace

dts::v1::Event reach_event(std::uint64_t instance_id, const core::ReachEvent& event) {
  dts::v1::Event out = at_scan(instance_id, event);
  set_reach(*out.mutable_reach(), event);
  return out;
}

dts::v1::Event class_event(std::uint64_t instance_id, const core::ClassEvent& event) {
  dts::v1::Event out = at_scan(instance_id, event);
  set_movement(*out.mutable_movement(), event.number, event.movement);
  return out;
}

dts::v1::TrialResult trial_result(const session::TrialResultNotice& notice) {
  dts::v1::TrialResult out;
  const session::ReachTrialResult& result = notice.result;
  out.set_session_id(notice.session_id);
  out.set_trial(result.trial);
  out.set_attempt(result.attempt);
  out.set_condition(result.condition);
  out.set_target_cm(result.target_cm.value_or(0.0));
  if (result.reach) set_reach(*out.mutable_reach(), *result.reach);
  if (result.reach && result.movement) set_movement(*out.mutable_movement(), result.reach->number, *result.movement);
  out.set_expected_class(static_cast<int>(result.expected.value_or(core::TrunkClass::Rejected)));
  return out;
}

}  // namespace dts::ipc
