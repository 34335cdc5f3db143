// SPDX-License-Identifier: Apache-2.0
#include "events/make.h"

#include <cmath>

namespace dts::events {
namespace {

using posturography::Measure;
namespace flag = posturography::sway_flag;

// The numbers of core and posturography are those of the protocol.
static_assert(static_cast<int>(core::GapReason::Stall) == v1::GAP_REASON_STALL && core::kGapReasons == v1::GapReason_ARRAYSIZE);
static_assert(static_cast<int>(core::ReachStep::Cancelled) == v1::REACH_STEP_CANCELLED);
static_assert(core::reach_flag::kNoInitiation == v1::REACH_FLAG_NO_INITIATION && core::reach_flag::kMinor == v1::REACH_FLAG_MINOR);
static_assert(core::class_reason::kDisagreement == v1::CLASS_REASON_DISAGREEMENT);
static_assert(flag::kShortRecord == v1::SWAY_FLAG_SHORT_RECORD && flag::kMissingSamples == v1::SWAY_FLAG_MISSING_SAMPLES &&
              flag::kConstant == v1::SWAY_FLAG_CONSTANT && flag::kSteppedOff == v1::SWAY_FLAG_STEPPED_OFF &&
              flag::kMoved == v1::SWAY_FLAG_MOVED && flag::kDoubtful == v1::SWAY_FLAG_DOUBTFUL &&
              flag::kUnclearCriticalPoint == v1::SWAY_FLAG_UNCLEAR_CRITICAL_POINT);

/// Sets a field if the value is known. Negative zero becomes zero.
template <class Message>
void set(Message& out, void (Message::*setter)(double), double value) {
  if (std::isfinite(value)) (out.*setter)(value + 0.0);
}

template <class Found>
v1::Event at_scan(const Found& found) {
  v1::Event event;
  event.set_segment(found.segment);
  event.set_scan(found.scan.value);
  if (found.host_time_ns != 0) event.set_host_time_ns(found.host_time_ns);
  return event;
}

void set(v1::ReachPoint* (v1::Reach::*mutable_point)(), v1::Reach& out, const core::ReachPoint& point) {
  if (!std::isfinite(point.value_mm)) return;
  v1::ReachPoint& made = *(out.*mutable_point)();
  made.set_scan(point.scan.value);
  made.set_value_mm(point.value_mm + 0.0);
}

void add(Measure measure, double value, v1::Sway& out) {
  if (!std::isfinite(value)) return;
  const posturography::MeasureInfo& about = posturography::info(measure);
  v1::SwayMeasure& entry = *out.add_measures();
  entry.set_symbol(std::string(about.symbol));
  entry.set_value(value + 0.0);
  entry.set_unit(std::string(about.unit));
}

void add(const core::RunningSway& values, v1::Sway& out) {
  if (values.samples < 2) return;
  const double duration_s = static_cast<double>(values.samples) / values.rate_hz;
  add(Measure::Rdist, values.rdist_mm, out);
  add(Measure::RdistAp, values.rdist_ap_mm, out);
  add(Measure::RdistMl, values.rdist_ml_mm, out);
  add(Measure::Totex, values.totex_mm, out);
  add(Measure::TotexAp, values.totex_ap_mm, out);
  add(Measure::TotexMl, values.totex_ml_mm, out);
  add(Measure::Mvelo, values.totex_mm / duration_s, out);
  add(Measure::MveloAp, values.totex_ap_mm / duration_s, out);
  add(Measure::MveloMl, values.totex_ml_mm / duration_s, out);
  add(Measure::RangeAp, values.range_ap_mm, out);
  add(Measure::RangeMl, values.range_ml_mm, out);
  if (values.samples < 3) return;
  add(Measure::Pea95F, values.pea95_f_mm2, out);
  add(Measure::EllSd1, values.ellipse_sd1_mm, out);
  add(Measure::EllSd2, values.ellipse_sd2_mm, out);
  add(Measure::EllAngle, values.ellipse_angle_deg, out);
}

/// Only the measures that can be exact during a trial.
v1::Sway preliminary(const core::SwayEvent& event) {
  v1::Sway out;
  out.set_is_preliminary(true);
  out.set_trial(event.trial);
  out.set_first_segment(event.segment);
  out.set_first_scan(event.first_scan.value);
  out.set_end_segment(event.segment);
  out.set_end_scan(event.scan.value + 1);
  out.set_profile(std::string(posturography::name(posturography::Profile::Lp10)));
  out.set_samples(event.values.samples);
  if (event.values.rate_hz > 0.0) {
    out.set_rate_hz(event.values.rate_hz);
    out.set_duration_s(static_cast<double>(event.values.samples) / event.values.rate_hz);
  }
  out.set_flags(0);
  out.set_is_valid(true);
  out.set_window(event.trial > 0 ? v1::SWAY_WINDOW_TRIAL : v1::SWAY_WINDOW_LATEST);
  if (event.trial == 0) out.set_window_s(core::kRecentSwayS);
  add(event.values, out);
  return out;
}

}  // namespace

v1::Event make_gap(const core::Frame& frame) {
  v1::Event event;
  event.set_segment(frame.segment);
  event.set_host_time_ns(frame.host_time_ns);
  *event.mutable_gap() = to_message(frame.gap_before);
  return event;
}

v1::Event make(const core::Event& event, const std::string& trigger_channel) {
  v1::Event out = std::visit([](const auto& found) { return at_scan(found); }, event);
  if (const auto* trigger = std::get_if<core::TriggerEvent>(&event)) {
    out.mutable_trigger()->set_edge(trigger->is_rising ? v1::TRIGGER_EDGE_RISING : v1::TRIGGER_EDGE_FALLING);
    out.mutable_trigger()->set_channel(trigger_channel);
  }
  if (const auto* reach = std::get_if<core::ReachEvent>(&event)) *out.mutable_reach() = to_message(*reach);
  if (const auto* classified = std::get_if<core::ClassEvent>(&event))
    *out.mutable_movement() = to_message(classified->movement, classified->number);
  if (const auto* sway = std::get_if<core::SwayEvent>(&event)) *out.mutable_sway() = preliminary(*sway);
  return out;
}

v1::Gap to_message(const core::Gap& gap) {
  v1::Gap out;
  out.set_reason(static_cast<v1::GapReason>(gap.reason));
  out.set_missing_scans(gap.missing_scans);
  out.set_is_exact(gap.is_exact);
  return out;
}

v1::Reach to_message(const core::ReachEvent& event) {
  v1::Reach out;
  out.set_step(static_cast<v1::ReachStep>(event.step));
  out.set_number(event.number);
  set(&v1::Reach::mutable_p1, out, event.p1);
  set(&v1::Reach::mutable_p2, out, event.p2);
  set(&v1::Reach::mutable_p3, out, event.p3);
  const core::ReachFeatures& features = event.features;
  set(out, &v1::Reach::set_d1_mm, features.d1_mm());
  set(out, &v1::Reach::set_d2_mm, features.d2_mm());
  set(out, &v1::Reach::set_hold_mm, features.hold_mm);
  set(out, &v1::Reach::set_rise_s, features.rise_s);
  set(out, &v1::Reach::set_rest_ratio, features.rest_ratio);
  set(out, &v1::Reach::set_ratio_change, features.ratio_change);
  set(out, &v1::Reach::set_twist, features.twist);
  set(out, &v1::Reach::set_smoothness, features.smoothness);
  out.set_flags(event.flags);
  out.set_resumed(event.resumed);
  return out;
}

v1::TrunkMovement to_message(const core::TrunkMovement& movement, std::uint32_t number) {
  v1::TrunkMovement out;
  out.set_number(number);
  out.set_trunk_class(static_cast<int>(movement.trunk_class));
  for (const double probability : movement.probability) out.add_probability(probability);
  set(out, &v1::TrunkMovement::set_trunk_deg, movement.trunk_deg);
  set(out, &v1::TrunkMovement::set_trunk_lo_deg, movement.trunk_lo_deg);
  set(out, &v1::TrunkMovement::set_trunk_hi_deg, movement.trunk_hi_deg);
  out.set_reasons(movement.reasons);
  return out;
}

void add(const posturography::Analysis& analysis, v1::Sway& out) {
  out.set_profile(std::string(posturography::name(analysis.profile)));
  out.set_rate_hz(analysis.rate_hz);
  out.set_samples(analysis.samples);
  out.set_duration_s(analysis.duration_s);
  out.set_flags(analysis.flags);
  out.set_is_valid(analysis.is_valid());
  out.set_missing(analysis.missing);
  out.set_interpolated(analysis.interpolated);
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    if (const auto value = analysis.measures.get(measure)) add(measure, *value, out);
  }
}

}  // namespace dts::events
