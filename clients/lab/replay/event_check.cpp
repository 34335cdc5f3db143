// SPDX-License-Identifier: Apache-2.0
#include "lab/replay/event_check.h"

#include "record/reach_record.h"

namespace dts::lab::replay {
namespace {

constexpr const char* kNone = "none";

}  // namespace

void EventCheck::add_recorded(const record::RecordedEvent& event) {
  if (is_stopped_ || (event.event != "reach" && event.event != "class")) return;
  Kind& kind = event.event == "reach" ? reaches_ : classes_;
  kind.recorded.push_back(event);
  match(kind);
}

void EventCheck::add_computed(const core::FrameEvents& events) {
  if (is_stopped_) return;
  for (const core::ReachEvent& reach : events.reaches.all_of()) reaches_.computed.push_back(record::to_record(reach));
  for (const core::ClassEvent& movement : events.classes.all_of()) classes_.computed.push_back(record::to_record(movement));
  match(reaches_);
  match(classes_);
}

void EventCheck::match(Kind& kind) {
  while (!kind.recorded.empty() && !kind.computed.empty()) {
    const std::string recorded = record::to_json(kind.recorded.front());
    const std::string computed = record::to_json(kind.computed.front());
    if (recorded != computed) note(kind.recorded.front(), recorded, computed);
    ++compared_;
    kind.recorded.pop_front();
    kind.computed.pop_front();
  }
}

void EventCheck::finish(bool is_torn) {
  if (is_stopped_ || is_torn) return;
  for (const Kind* kind : {&reaches_, &classes_}) {
    if (!kind->recorded.empty()) note(kind->recorded.front(), record::to_json(kind->recorded.front()), kNone);
    if (!kind->computed.empty()) note(kind->computed.front(), kNone, record::to_json(kind->computed.front()));
  }
}

void EventCheck::note(const record::RecordedEvent& at, const std::string& recorded, const std::string& computed) {
  if (difference_) return;
  difference_ = Difference{.segment = at.segment, .scan = at.scan.value, .channel = at.event, .recorded = recorded, .computed = computed};
}

}  // namespace dts::lab::replay
