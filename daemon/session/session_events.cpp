// SPDX-License-Identifier: Apache-2.0
#include "session/session_events.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "events/make.h"
#include "events/read.h"
#include "record/utf8_text.h"

namespace dts::session {
namespace {

using record::clean_text;
using Labels = std::vector<std::pair<std::string, std::string>>;

constexpr int kMostLabels = 32;

// The numbers of the state machines are those of the protocol.
static_assert(static_cast<int>(SessionState::Idle) == v1::SESSION_STATE_IDLE);
static_assert(static_cast<int>(SessionState::Failed) == v1::SESSION_STATE_FAILED);
static_assert(static_cast<int>(TrialEventKind::Ready) == v1::TRIAL_EVENT_KIND_READY);
static_assert(static_cast<int>(TrialEventKind::Done) == v1::TRIAL_EVENT_KIND_DONE);
static_assert(static_cast<int>(TrialEventKind::Finished) == v1::TRIAL_EVENT_KIND_FINISHED);
static_assert(static_cast<int>(TrialEventKind::Undone) == v1::TRIAL_EVENT_KIND_UNDONE);

using LabelMap = google::protobuf::Map<std::string, std::string>;

void add(const Labels& labels, LabelMap& out) {
  for (const auto& [label, word] : labels) out[clean_text(label)] = clean_text(word);
}

/// Returns the labels sorted by name: a map of protobuf has no order.
Labels labels_of(const LabelMap& map) {
  Labels labels(map.begin(), map.end());
  std::ranges::sort(labels);
  return labels;
}

}  // namespace

v1::Event marker_event(const std::string& text) {
  v1::Event event;
  event.mutable_marker()->set_text(clean_text(text));
  return event;
}

v1::Event device_event(device::DeviceState state, const std::string& uri, const std::string& message) {
  v1::Event event;
  v1::DeviceChange& out = *event.mutable_device();
  out.set_state(to_message(state));
  out.set_uri(clean_text(uri));
  out.set_message(clean_text(message));
  return event;
}

v1::Event to_event(const SessionView& view) {
  v1::Event event;
  v1::SessionChange& out = *event.mutable_session();
  out.set_session_id(view.id);
  out.set_state(static_cast<v1::SessionState>(view.state));
  out.set_protocol(view.request.protocol);
  out.set_subject(view.request.subject);
  out.set_label(clean_text(view.request.label));
  out.set_message(clean_text(view.message));
  return event;
}

v1::Event to_event(const TrialEvent& event, const std::string& session_id) {
  v1::Event made;
  v1::TrialChange& out = *made.mutable_trial();
  out.set_session_id(session_id);
  out.set_step(static_cast<v1::TrialEventKind>(event.kind));
  out.set_trial(event.trial);
  out.set_attempt(event.attempt);
  out.set_block(event.block);
  out.set_condition(clean_text(event.condition));
  add(event.labels, *out.mutable_labels());
  if (event.target_cm) out.set_target_cm(*event.target_cm);
  if (event.rest_s > 0.0) out.set_rest_s(event.rest_s);
  return made;
}

v1::Event to_event(const ReachTrialResult& result, const std::string& session_id) {
  v1::Event event;
  v1::TrialResult& out = *event.mutable_trial_result();
  out.set_session_id(session_id);
  out.set_trial(result.trial);
  out.set_attempt(result.attempt);
  out.set_condition(clean_text(result.condition));
  if (result.target_cm) out.set_target_cm(*result.target_cm);
  if (result.reach) *out.mutable_reach() = events::to_message(*result.reach);
  if (result.reach && result.movement) *out.mutable_movement() = events::to_message(*result.movement, result.reach->number);
  if (result.expected) out.set_expected_class(static_cast<int>(*result.expected));
  out.set_has_gap(result.has_gap);
  return event;
}

v1::Event to_event(const SwayTrialResult& result, const std::string& session_id, const std::string& software) {
  v1::Event event;
  v1::Sway& out = *event.mutable_sway();
  out.set_session_id(session_id);
  out.set_trial(result.trial);
  out.set_attempt(result.attempt);
  out.set_condition(clean_text(result.condition));
  add(result.labels, *out.mutable_labels());
  out.set_first_segment(result.segment);
  out.set_first_scan(result.first_scan.value);
  out.set_end_segment(result.end_segment);
  out.set_end_scan(result.end_scan.value);
  out.set_software(clean_text(software));
  out.set_problem(clean_text(result.problem));
  if (result.analysis) events::add(*result.analysis, out);
  if (result.decision) *out.mutable_decision() = *result.decision;
  if (result.mean_load_n) out.set_mean_load_n(*result.mean_load_n);
  return event;
}

v1::Event to_event(const SessionFigure& result) {
  v1::Event event;
  v1::SessionResult& out = *event.mutable_figure();
  out.set_name(clean_text(result.name));
  out.set_value(result.value);
  out.set_unit(result.unit);
  out.set_details(clean_text(result.details));
  return event;
}

v1::DeviceState to_message(device::DeviceState state) {
  switch (state) {
    case device::DeviceState::Closed: return v1::DEVICE_STATE_CLOSED;
    case device::DeviceState::Open: return v1::DEVICE_STATE_OPEN;
    case device::DeviceState::Streaming: return v1::DEVICE_STATE_STREAMING;
    case device::DeviceState::Gone: return v1::DEVICE_STATE_GONE;
  }
  return v1::DEVICE_STATE_UNSPECIFIED;
}

core::Result<TrialEvent> trial_of(const v1::Event& event) {
  const v1::TrialChange& message = event.trial();
  if (message.step() < v1::TRIAL_EVENT_KIND_READY || message.step() > v1::TRIAL_EVENT_KIND_UNDONE) {
    return tl::make_unexpected(events::damaged(event, "step"));
  }
  if (message.labels_size() > kMostLabels) return tl::make_unexpected(events::damaged(event, "labels"));
  const auto known = [](bool is_known, double value) { return is_known && std::isfinite(value) ? std::optional(value) : std::nullopt; };
  return TrialEvent{.kind = static_cast<TrialEventKind>(message.step()),
                    .trial = message.trial(),
                    .attempt = message.attempt(),
                    .block = std::max(message.block(), 1U),
                    .condition = message.condition(),
                    .labels = labels_of(message.labels()),
                    .target_cm = known(message.has_target_cm(), message.target_cm()),
                    .rest_s = known(message.has_rest_s(), message.rest_s()).value_or(0.0)};
}

core::Result<ReachTrialResult> reach_result_of(const v1::Event& event) {
  const v1::TrialResult& message = event.trial_result();
  if (!event.has_trial_result()) return tl::make_unexpected(events::damaged(event, "trial_result"));
  ReachTrialResult result{
      .trial = message.trial(), .attempt = message.attempt(), .condition = message.condition(), .segment = event.segment()};
  if (message.has_target_cm() && std::isfinite(message.target_cm())) result.target_cm = message.target_cm();
  if (message.has_expected_class()) {
    if (message.expected_class() < 0 || message.expected_class() > 3) return tl::make_unexpected(events::damaged(event, "expected_class"));
    result.expected = static_cast<core::TrunkClass>(message.expected_class());
  }
  v1::Event part;  // the two messages as the events that they were
  part.set_segment(event.segment());
  part.set_scan(event.scan());
  if (message.has_reach()) {
    *part.mutable_reach() = message.reach();
    DTS_TRY_ASSIGN(result.reach, events::reach_of(part));
  }
  if (message.has_movement()) {
    *part.mutable_movement() = message.movement();
    DTS_TRY_ASSIGN(const auto movement, events::class_of(part));
    result.movement = movement.movement;
  }
  return result;
}

core::Result<SwayTrialResult> sway_of(const v1::Event& event) {
  const v1::Sway& message = event.sway();
  if (!event.has_sway() || message.is_preliminary()) return tl::make_unexpected(events::damaged(event, "is_preliminary"));
  if (message.labels_size() > kMostLabels) return tl::make_unexpected(events::damaged(event, "labels"));
  SwayTrialResult result{.trial = message.trial(),
                         .attempt = message.attempt(),
                         .condition = message.condition(),
                         .labels = labels_of(message.labels()),
                         .segment = message.first_segment(),
                         .first_scan = {message.first_scan()},
                         .end_scan = {message.end_scan()},
                         .end_segment = message.end_segment(),
                         .problem = message.problem()};
  if (!result.problem.empty()) return result;
  auto analysis = events::analysis_of(message);
  if (!analysis) {
    core::Error error = events::damaged(event, "result");
    error.what += ": " + analysis.error().what;
    return tl::make_unexpected(error);
  }
  result.analysis = *analysis;
  if (message.has_decision()) result.decision = message.decision();
  if (message.has_mean_load_n()) {
    if (!std::isfinite(message.mean_load_n())) return tl::make_unexpected(events::damaged(event, "mean_load_n"));
    result.mean_load_n = message.mean_load_n();
  }
  return result;
}

}  // namespace dts::session
