// SPDX-License-Identifier: Apache-2.0
#include "lab/replay/event_check.h"

#include "dts/wire/event_json.h"
#include "dts/wire/options.h"
#include "events/make.h"

namespace dts::lab::replay {
namespace {

constexpr const char* kNone = "none";

/// Returns an event without what differs between a recording and its replay: the host's time.
v1::Event comparable(v1::Event event) {
  event.clear_host_time_ns();
  event.clear_instance_id();
  return event;
}

}  // namespace

void EventCheck::add_recorded(const v1::Event& event) {
  if (is_stopped_ || !(event.has_reach() || event.has_movement())) return;
  Kind& kind = event.has_reach() ? reaches_ : classes_;
  kind.recorded.push_back(comparable(event));
  match(kind);
}

void EventCheck::add_computed(const core::FrameEvents& events) {
  if (is_stopped_) return;
  for (const core::ReachEvent& reach : events.reaches.all_of()) reaches_.computed.push_back(comparable(events::make(reach, {})));
  for (const core::ClassEvent& movement : events.classes.all_of()) classes_.computed.push_back(comparable(events::make(movement, {})));
  match(reaches_);
  match(classes_);
}

void EventCheck::match(Kind& kind) {
  while (!kind.recorded.empty() && !kind.computed.empty()) {
    const v1::Event& recorded = kind.recorded.front();
    const v1::Event& computed = kind.computed.front();
    if (recorded.SerializeAsString() != computed.SerializeAsString()) note(recorded, wire::to_json(recorded), wire::to_json(computed));
    ++compared_;
    kind.recorded.pop_front();
    kind.computed.pop_front();
  }
}

void EventCheck::finish(bool is_torn) {
  if (is_stopped_ || is_torn) return;
  for (const Kind* kind : {&reaches_, &classes_}) {
    if (!kind->recorded.empty()) note(kind->recorded.front(), wire::to_json(kind->recorded.front()), kNone);
    if (!kind->computed.empty()) note(kind->computed.front(), kNone, wire::to_json(kind->computed.front()));
  }
}

void EventCheck::note(const v1::Event& at, const std::string& recorded, const std::string& computed) {
  if (difference_) return;
  difference_ =
      Difference{.segment = at.segment(), .scan = at.scan(), .channel = wire::kind_of(at), .recorded = recorded, .computed = computed};
}

}  // namespace dts::lab::replay
